#include "drivers/lrf/sopas/telegram.hpp"

#include <algorithm>
#include <bit>

namespace odoless::sopas {
namespace {

constexpr char kStx = '\x02';
constexpr char kEtx = '\x03';
constexpr std::size_t kBinaryHead = 8;  ///< four starts and the length
constexpr std::size_t kShortest = 3;    ///< "sFA"

bool is_text(char c) { return c >= 0x20 && c <= 0x7E; }

/// What a hexadecimal digit of either case is worth; 16: it is none. A table, for a branch would go either way.
constexpr std::array<std::uint8_t, 256> kDigits = [] {
  std::array<std::uint8_t, 256> table{};
  table.fill(16);
  for (std::uint8_t digit = 0; digit < 16; ++digit) {
    table[static_cast<unsigned char>("0123456789ABCDEF"[digit])] = digit;
    table[static_cast<unsigned char>("0123456789abcdef"[digit])] = digit;
  }
  return table;
}();

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char c : bytes) {
    number = number << 8U | static_cast<unsigned char>(c);
  }
  return number;
}

char sum_of(std::string_view bytes) {
  unsigned sum = 0;
  for (const char c : bytes) {
    sum ^= static_cast<unsigned char>(c);
  }
  return static_cast<char>(sum);
}

}  // namespace

std::uint32_t Fields::fail() {
  ok_ = false;
  rest_ = {};
  return 0;
}

std::string_view Fields::take(std::size_t size_bytes) {
  if (size_bytes > rest_.size()) {
    static_cast<void>(fail());
    return {};
  }
  const std::string_view taken = rest_.substr(0, size_bytes);
  rest_.remove_prefix(size_bytes);
  return taken;
}

std::string_view Fields::word() {
  const std::size_t end = std::min(rest_.find(' '), rest_.size());
  const std::string_view taken = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  return taken;
}

std::uint32_t Fields::number(int bytes) {
  if (dialect_ == Dialect::kBinary) {
    return big_endian(take(static_cast<std::size_t>(bytes)));
  }
  const std::string_view text = rest_;
  const char sign = text.empty() ? ' ' : text.front();
  const bool is_decimal = sign == '+' || sign == '-';
  const unsigned base = is_decimal ? 10 : 16;
  const std::int64_t limit = std::int64_t{1} << (8 * bytes);
  const std::size_t begin = is_decimal ? 1 : 0;
  std::size_t end = begin;
  std::int64_t value = 0;
  for (; end < text.size() && text[end] != ' '; ++end) {
    const unsigned digit = kDigits[static_cast<unsigned char>(text[end])];
    if (digit >= base || value >= limit) {
      return fail();
    }
    value = value * base + digit;
  }
  value = sign == '-' ? -value : value;
  if (end == begin || value >= limit || value < -limit / 2) {
    return fail();
  }
  rest_.remove_prefix(std::min(end + 1, text.size()));
  return static_cast<std::uint32_t>(value & (limit - 1));
}

float Fields::real() { return std::bit_cast<float>(number(4)); }

std::string_view Fields::text(std::size_t size_bytes) {
  const std::string_view taken = dialect_ == Dialect::kBinary ? take(size_bytes) : word();
  if (taken.size() != size_bytes) {
    static_cast<void>(fail());
  }
  return taken;
}

std::size_t Fields::left() const {
  const auto spaces = static_cast<std::size_t>(std::count(rest_.begin(), rest_.end(), ' '));
  return dialect_ == Dialect::kBinary || rest_.empty() ? rest_.size() : spaces + 1;
}

std::string_view Telegram::name() const {
  const std::string_view rest = content.substr(std::min<std::size_t>(4, content.size()));
  return is_refusal() ? std::string_view() : rest.substr(0, rest.find(' '));
}

Fields Telegram::fields() const {
  const std::size_t head = command().size() + (is_refusal() ? 0 : 1 + name().size());
  const std::size_t space = head < content.size() && content[head] == ' ' ? 1 : 0;  // some refusals have none
  return {dialect, content.substr(std::min(head + space, content.size()))};
}

int Telegram::refusal_code() const {
  Fields fields = this->fields();
  const auto code = static_cast<int>(fields.number(2));
  return fields.ok() ? code : -1;
}

Request::Request(Dialect dialect, std::string_view head)
    : dialect_(dialect), size_(dialect == Dialect::kBinary ? kHeadBytes : 1) {
  bytes_.fill(kStx);
  std::for_each(head.begin(), head.end(), [&](char c) { put(c); });
}

Request& Request::number(std::uint32_t value, int bytes, int digits) {
  if (dialect_ == Dialect::kAscii || !has_values_) {
    put(' ');
  }
  has_values_ = true;
  if (dialect_ == Dialect::kBinary) {
    for (int byte = bytes - 1; byte >= 0; --byte) {
      put(static_cast<char>(value >> (8U * static_cast<unsigned>(byte))));
    }
    return *this;
  }
  for (int digit = 7; digit >= 0; --digit) {
    const unsigned shift = 4U * static_cast<unsigned>(digit);
    if (digit < digits || value >> shift != 0) {
      put("0123456789ABCDEF"[value >> shift & 15U]);
    }
  }
  return *this;
}

std::span<const std::byte> Request::finish() {
  if (dialect_ == Dialect::kAscii) {
    put(kEtx);
  } else {
    const std::string_view content(bytes_.data() + kHeadBytes, size_ - kHeadBytes);
    for (unsigned byte = 0; byte < 4; ++byte) {
      bytes_[4 + byte] = static_cast<char>(content.size() >> (8U * (3 - byte)));
    }
    put(sum_of(content));
  }
  return std::as_bytes(std::span(bytes_.data(), size_));
}

void TelegramReader::clear() {
  begin_ = end_ = seen_ = done_bytes_ = 0;
  is_skipping_ = false;
  limit_bytes_ = bytes_.size() - kFrameBytes;
}

void TelegramReader::set_limit(std::size_t content_bytes) {
  limit_bytes_ = std::min(content_bytes, bytes_.size() - kFrameBytes);
}

TelegramReader::Outcome TelegramReader::take(std::span<const std::byte>& bytes) {
  begin_ += done_bytes_;
  done_bytes_ = 0;
  for (;;) {
    if (const Outcome outcome = inspect(); outcome != Outcome::kMore || bytes.empty()) {
      return outcome;
    }
    if (end_ == bytes_.size()) {
      std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), bytes_.end(), bytes_.begin());
      end_ -= begin_;
      begin_ = 0;
    }
    const std::size_t count = std::min(bytes.size(), bytes_.size() - end_);
    std::transform(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count),
                   bytes_.begin() + static_cast<std::ptrdiff_t>(end_),
                   [](std::byte b) { return static_cast<char>(b); });
    end_ += count;
    bytes = bytes.subspan(count);
  }
}

TelegramReader::Outcome TelegramReader::skip(Outcome outcome) {
  begin_ += std::min(kept().find(kStx, 1), kept().size());
  seen_ = 0;
  is_skipping_ = true;
  return outcome;
}

TelegramReader::Outcome TelegramReader::found(Dialect dialect, std::string_view content, std::size_t frame_bytes) {
  telegram_ = {dialect, content};
  done_bytes_ = frame_bytes;
  seen_ = 0;
  is_skipping_ = false;
  return Outcome::kTelegram;
}

TelegramReader::Outcome TelegramReader::inspect() {
  for (;;) {
    const std::string_view have = kept();
    const bool was_skipping = is_skipping_;
    Outcome outcome = Outcome::kMore;
    if (have.empty() || (have.size() == 1 && have[0] == kStx)) {
      return Outcome::kMore;
    }
    if (have[0] == kStx && have[1] == 's') {
      outcome = inspect_ascii(have);
    } else if (have[0] == kStx && have[1] == kStx) {
      outcome = inspect_binary(have);
    } else {
      outcome = skip(Outcome::kSkipped);
    }
    if (outcome != Outcome::kSkipped || !was_skipping) {
      return outcome;
    }
  }
}

TelegramReader::Outcome TelegramReader::inspect_ascii(std::string_view have) {
  const auto* const from = have.begin() + std::max<std::size_t>(seen_, 1);
  const auto* const stop = std::find_if_not(from, have.end(), is_text);
  const auto size = static_cast<std::size_t>(stop - have.begin()) - 1;
  if (size > limit_bytes_) {
    return skip(Outcome::kSkipped);
  }
  if (stop == have.end()) {
    seen_ = have.size();
    return Outcome::kMore;
  }
  if (*stop != kEtx || size < kShortest) {
    return skip(Outcome::kSkipped);
  }
  return found(Dialect::kAscii, have.substr(1, size), size + 2);
}

TelegramReader::Outcome TelegramReader::inspect_binary(std::string_view have) {
  const std::string_view starts = have.substr(0, 4);
  if (starts.find_first_not_of(kStx) != std::string_view::npos) {
    return skip(Outcome::kSkipped);
  }
  if (have.size() <= kBinaryHead) {
    return Outcome::kMore;
  }
  const std::size_t size = big_endian(have.substr(4, 4));
  if (size < kShortest || size > limit_bytes_ || have[kBinaryHead] != 's') {
    return skip(Outcome::kSkipped);
  }
  if (have.size() < kBinaryHead + size + 1) {
    return Outcome::kMore;
  }
  const std::string_view content = have.substr(kBinaryHead, size);
  if (sum_of(content) != have[kBinaryHead + size]) {
    return skip(Outcome::kWrongSum);
  }
  return found(Dialect::kBinary, content, kBinaryHead + size + 1);
}

}  // namespace odoless::sopas
