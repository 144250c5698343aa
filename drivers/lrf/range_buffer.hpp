#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace odoless {

/// The ranges of the scan that is read and of the one before it, to tell when a device repeats itself.
/// Thread: one thread. Real time: no allocation after construction.
class RangeBuffer {
 public:
  explicit RangeBuffer(int beams_max)
      : now_(static_cast<std::size_t>(beams_max)), before_(static_cast<std::size_t>(beams_max)) {}

  [[nodiscard]] int beams_max() const { return static_cast<int>(now_.size()); }

  /// Where the next scan is to be written.
  [[nodiscard]] std::span<float> next(int beams) {
    beams_ = static_cast<std::size_t>(beams);
    return {now_.data(), beams_};
  }

  /// The next scan is written: valid until the one after it is.
  [[nodiscard]] std::span<const float> seal();

  /// How many scans in a row, up to the last one, were equal to the one before them.
  [[nodiscard]] std::uint64_t identical_run() const { return identical_run_; }
  void restart() { identical_run_ = 0; }

 private:
  std::vector<float> now_;
  std::vector<float> before_;
  std::size_t beams_ = 0;
  std::size_t beams_before_ = 0;
  std::uint64_t identical_run_ = 0;
};

}  // namespace odoless
