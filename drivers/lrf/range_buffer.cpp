#include "drivers/lrf/range_buffer.hpp"

#include <algorithm>

namespace odoless {

std::span<const float> RangeBuffer::seal() {
  const auto end = now_.begin() + static_cast<std::ptrdiff_t>(beams_);
  const bool identical = beams_ == beams_before_ && std::equal(now_.begin(), end, before_.begin());
  identical_run_ = identical ? identical_run_ + 1 : 0;
  now_.swap(before_);
  beams_before_ = beams_;
  return {before_.data(), beams_};
}

}  // namespace odoless
