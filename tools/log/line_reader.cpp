#include "tools/log/line_reader.hpp"

#include <utility>

#include "tools/command/error.hpp"

namespace odoless {
namespace {
constexpr std::size_t kChunkBytes = std::size_t{64} * 1024;
constexpr std::size_t kLineBytesMax = std::size_t{1024} * 1024;
}  // namespace

LineReader::LineReader(std::unique_ptr<ByteStream> bytes, std::string name)
    : bytes_(std::move(bytes)), name_(std::move(name)) {}

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
