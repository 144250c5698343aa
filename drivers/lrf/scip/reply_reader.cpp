#include "drivers/lrf/scip/reply_reader.hpp"

#include <algorithm>
#include <cstring>

namespace odoless::scip {

ReplyReader::ReplyReader(std::size_t text_max_bytes, std::size_t lines_max) : text_(text_max_bytes), ends_(lines_max) {}

void ReplyReader::clear() {
  used_ = 0;
  lines_ = 0;
  complete_ = false;
  too_long_ = false;
}

std::string_view ReplyReader::current_line() const {
  const std::size_t start = lines_ == 0 ? 0 : ends_[lines_ - 1];
  return {text_.data() + start, used_ - start};
}

void ReplyReader::drop_all_but(std::string_view line) {
  std::copy(line.begin(), line.end(), text_.begin());  // forwards: it may overlap what is behind it
  used_ = line.size();
  lines_ = 0;
}

ReplyReader::Outcome ReplyReader::end_line() {
  const std::string_view line = current_line();
  if (line.empty()) {
    complete_ = lines_ > 0 && !too_long_;
    if (complete_) {
      return Outcome::kReply;
    }
    const bool cut = too_long_;
    clear();
    return cut ? Outcome::kCut : Outcome::kMore;
  }
  // At the end of a line will do: the byte before it may be what became of the lost line end.
  const bool starts_anew = (lines_ > 0 || too_long_) && !stream_echo_.empty() && line.ends_with(stream_echo_);
  if (starts_anew || lines_ == ends_.size()) {
    drop_all_but(starts_anew ? line.substr(line.size() - stream_echo_.size()) : line);
    too_long_ = !starts_anew;
  }
  ends_[lines_++] = used_;
  return starts_anew ? Outcome::kCut : Outcome::kMore;
}

ReplyReader::Outcome ReplyReader::take(std::string_view& bytes) {
  if (complete_) {
    clear();
  }
  while (!bytes.empty()) {
    const std::size_t line_end = std::min(bytes.find('\n'), bytes.size());
    if (line_end > text_.size() - used_) {
      too_long_ = true;  // drops what is there, and of this line what doesn't fit either
      drop_all_but({});
    }
    const std::size_t fits = std::min(line_end, text_.size() - used_);
    std::memcpy(text_.data() + used_, bytes.data(), fits);
    used_ += fits;
    if (line_end == bytes.size()) {
      bytes = {};
      return Outcome::kMore;
    }
    bytes.remove_prefix(line_end + 1);
    if (const Outcome outcome = end_line(); outcome != Outcome::kMore) {
      return outcome;
    }
  }
  return Outcome::kMore;
}

}  // namespace odoless::scip
