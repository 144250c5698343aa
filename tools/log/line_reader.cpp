#include "tools/log/line_reader.hpp"

#include <fmt/core.h>

#include <utility>

#include "tools/command/error.hpp"

namespace odoless {
namespace {
constexpr std::size_t kChunkBytes = std::size_t{64} * 1024;
constexpr std::size_t kLineBytesMax = std::size_t{1024} * 1024;
}  // namespace

LineReader::LineReader(std::unique_ptr<ByteStream> bytes, std::string name, std::size_t kept_bytes_max)
    : bytes_(std::move(bytes)), name_(std::move(name)), kept_bytes_max_(kept_bytes_max) {}

// What editors put before a text to say how it is encoded.
void LineReader::skip_mark() {
  constexpr std::string_view kUtf8 = "\xEF\xBB\xBF";
  while (buffer_.size() < kUtf8.size() && refill()) {
  }
  if (buffer_.starts_with("\xFF\xFE") || buffer_.starts_with("\xFE\xFF")) {
    throw DataError(name_, 1, "the text is encoded as UTF-16", "ASCII or UTF-8");
  }
  begin_ = buffer_.starts_with(kUtf8) ? kUtf8.size() : 0;
}

void LineReader::keep(std::size_t bytes) {
  kept_bytes_ += bytes;
  if (kept_bytes_ > kept_bytes_max_) {
    throw DataError(name_, number_,
                    fmt::format("what is read up to here takes more than {} MiB of memory", kept_bytes_max_ >> 20U),
                    "a shorter text, such as a part of this one");
  }
}

bool LineReader::refill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + kChunkBytes);
  const std::span<char> room(buffer_);
  const std::size_t got = bytes_->read(room.subspan(kept));
  buffer_.resize(kept + got);
  return got > 0;
}

std::string_view LineReader::take(std::size_t length, std::size_t skip) {
  std::string_view line = std::string_view(buffer_).substr(begin_, length);
  begin_ += length + skip;
  ++number_;
  if (line.ends_with('\r')) {
    line.remove_suffix(1);
  }
  return line;
}

bool LineReader::next(std::string_view& line) {
  if (number_ == 0) {
    skip_mark();
  } else if (number_ == kLinesMax) {
    throw DataError(name_, number_, fmt::format("there are more than {} lines", kLinesMax), "a shorter text");
  }
  std::size_t searched = 0;
  while (true) {
    const std::size_t end = buffer_.find('\n', begin_ + searched);
    if (end != std::string::npos) {
      line = take(end - begin_, 1);
      return true;
    }
    searched = buffer_.size() - begin_;
    if (searched > kLineBytesMax) {
      throw DataError(name_, number_ + 1, "the line is longer than 1 MiB", "a text file with one message per line");
    }
    if (!refill()) {
      const bool is_line = searched > 0;
      line = is_line ? take(searched, 0) : std::string_view();
      return is_line;
    }
  }
}

}  // namespace odoless
