#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace odoless {

/// Tells a laser that sends the same scan again and again, whole or with a few beams or a little noise changed, from
/// one that sees a scene at rest: a live laser shows its noise in every beam.
///
/// Two signs, from scan to scan: nine of ten returns are the very same number; or returns differ by much less than this
/// laser's quietest scans did. Of recorded logs, also of lasers that round to 1 cm, no two scans have more than 83 % of
/// their returns in common. A scene that comes to rest for the first time is taken for the second sign for a while.
///
/// Thread: owned by one thread. Real time: no allocation after construction; linear in the beams.
class StuckDetector {
 public:
  explicit StuckDetector(int beams_max);

  /// @param ranges_m  Of a scan; what is no return is infinite or not above 0.
  /// @return          Whether the laser repeats itself: this scan shows nothing that the one before did not.
  [[nodiscard]] bool add(std::span<const float> ranges_m);

 private:
  [[nodiscard]] bool is_too_quiet(float change_m);

  std::vector<float> last_m_;
  std::vector<float> changes_m_;
  std::optional<float> quietest_m_{};  ///< change that three scans in a row did not exceed, the least so far
  std::array<float, 2> recent_m_{};    ///< of the two scans before
  int scans_ = 0;
  int quiet_in_a_row_ = 0;
};

}  // namespace odoless
