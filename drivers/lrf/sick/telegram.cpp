#include "drivers/lrf/sick/telegram.hpp"

#include <algorithm>
#include <utility>

#include "core/base/check.hpp"

namespace odoless::sick {
namespace {

constexpr std::size_t kShortPayloadBytes = 40;  ///< messages that a device may send into its stream

}  // namespace

std::uint16_t checksum(std::span<const std::byte> bytes) {
  constexpr unsigned kPolynomial = 0x8005;
  unsigned sum = 0;
  unsigned before = 0;
  for (const std::byte byte : bytes) {
    const auto now = std::to_integer<unsigned>(byte);
    sum = (sum & 0x8000U) != 0 ? ((sum & 0x7FFFU) << 1U) ^ kPolynomial : sum << 1U;
    sum ^= now | (before << 8U);
    before = now;
  }
  return static_cast<std::uint16_t>(sum);
}

Request::Request(std::span<const std::byte> payload) {
  ODOLESS_CHECK(payload.size() + kHeadBytes + kSumBytes <= bytes_.size());
  bytes_[0] = kStx;
  bytes_[1] = kToDevice;
  bytes_[2] = static_cast<std::byte>(payload.size());
  std::copy(payload.begin(), payload.end(), bytes_.begin() + kHeadBytes);
  size_ = kHeadBytes + payload.size();
  const std::uint16_t sum = checksum({bytes_.data(), size_});
  bytes_[size_++] = static_cast<std::byte>(sum & 0xFFU);
  bytes_[size_++] = static_cast<std::byte>(sum >> 8U);
}

// Twice as long as a telegram, so that the rest need not be moved for each.
TelegramReader::TelegramReader(std::size_t payload_max_bytes)
    : bytes_(2 * (payload_max_bytes + kHeadBytes + kSumBytes)) {}

void TelegramReader::clear() {
  begin_ = 0;
  end_ = 0;
  done_bytes_ = 0;
  skipping_ = false;
}

bool TelegramReader::can_be_length(std::size_t payload_bytes) const {
  if (payload_bytes < 2 || payload_bytes > bytes_.size() / 2 - kHeadBytes - kSumBytes) {
    return false;
  }
  return stream_payload_bytes_ == 0 || payload_bytes <= kShortPayloadBytes ||
         (payload_bytes >= stream_payload_bytes_ && payload_bytes <= stream_payload_bytes_ + 2);
}

bool TelegramReader::can_start() const {
  const auto have = rest();
  return have[0] == kStx && (have.size() < 2 || have[1] == kFromDevice) &&
         (have.size() < kHeadBytes || can_be_length(number(have[2], have[3])));
}

/// What the first of the kept bytes begin; kMore: it cannot be told yet.
TelegramReader::Outcome TelegramReader::inspect() {
  while (begin_ < end_) {
    const auto have = rest();
    if (stream_payload_bytes_ == 0 && (have[0] == kAck || have[0] == kNak)) {
      ++begin_;
      return have[0] == kAck ? Outcome::kUnderstood : Outcome::kNotUnderstood;
    }
    if (can_start()) {
      return have.size() < kHeadBytes ? Outcome::kMore : inspect_telegram(have);
    }
    ++begin_;
    if (!std::exchange(skipping_, true)) {
      return Outcome::kSkipped;
    }
  }
  return Outcome::kMore;
}

TelegramReader::Outcome TelegramReader::inspect_telegram(std::span<const std::byte> have) {
  const std::size_t summed = kHeadBytes + number(have[2], have[3]);
  if (have.size() < summed + kSumBytes) {
    return Outcome::kMore;
  }
  if (number(have[summed], have[summed + 1]) != checksum(have.first(summed))) {
    ++begin_;  // the next one may start within it
    skipping_ = true;
    return Outcome::kWrongSum;
  }
  skipping_ = false;
  telegram_ = {have.subspan(kHeadBytes, summed - kHeadBytes)};
  done_bytes_ = summed + kSumBytes;
  return Outcome::kTelegram;
}

void TelegramReader::make_room() {
  if (begin_ > 0 && end_ == bytes_.size()) {
    std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), bytes_.begin() + static_cast<std::ptrdiff_t>(end_),
              bytes_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
}

TelegramReader::Outcome TelegramReader::take(std::span<const std::byte>& bytes) {
  begin_ += done_bytes_;
  done_bytes_ = 0;
  for (;;) {
    if (const Outcome outcome = inspect(); outcome != Outcome::kMore) {
      return outcome;
    }
    if (bytes.empty()) {
      return Outcome::kMore;
    }
    make_room();
    // No more than half of the room waits, for no telegram is longer: there always is room.
    const std::size_t count = std::min(bytes.size(), bytes_.size() - end_);
    std::copy_n(bytes.begin(), count, bytes_.begin() + static_cast<std::ptrdiff_t>(end_));
    end_ += count;
    bytes = bytes.subspan(count);
  }
}

}  // namespace odoless::sick
