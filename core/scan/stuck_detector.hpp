#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace odoless {

/// Tells a laser that sends the same scan again and again, whole or with a few beams or a little noise changed, from
/// one that sees a scene at rest: a live laser shows its noise in every beam.
///
/// Two signs, from scan to scan: nine of ten returns are the very same number, which no scene does (of recorded logs
/// of lasers that round to 1 cm, no two scans have more than 83 % in common), or six of ten, where the laser tells
/// millimetres (46 % at most, but for scans that a URG-04LX did repeat whole); or returns differ by much less than
/// this laser's quietest scans did, which a scene that comes to rest for the first time does for a while, too. Where
/// the next scan that differs more shows the same scene, that was the laser's noise, and it is what the quietest scans
/// have from then on.
///
/// Thread: owned by one thread. Real time: no allocation after construction; linear in the beams.
class StuckDetector {
 public:
  explicit StuckDetector(int beams_max);

  /// @param ranges_m  Of a scan; what is no return is infinite or not above 0.
  void add(std::span<const float> ranges_m);

  /// The last scan repeats the one before, for sure: it tells nothing of now.
  [[nodiscard]] bool repeats() const { return repeats_; }
  /// The laser repeats itself, for sure or by its lack of noise.
  [[nodiscard]] bool is_suspect() const { return repeats_ || is_too_quiet_; }
  /// Suspect, or so for so long by its lack of noise that it is taken for a scene at rest.
  [[nodiscard]] bool may_be_stuck() const { return repeats_ || quiet_in_a_row_ > 0; }
  /// The last scan is none of these, but those before it told nothing of their time: for sure, or since it shows
  /// another scene.
  [[nodiscard]] bool was_stuck() const { return was_stuck_ && !may_be_stuck(); }

 private:
  [[nodiscard]] bool is_unlike_its_noise(float change_m);

  std::vector<float> last_m_;
  std::vector<float> changes_m_;
  float finest_m_ = std::numeric_limits<float>::infinity();  ///< least change of a return that there was
  std::optional<float> quietest_m_{};  ///< change that three scans in a row did not exceed, the least so far
  std::array<float, 2> recent_m_{};    ///< of the two scans before
  int scans_ = 0;
  int quiet_in_a_row_ = 0;
  float loudest_quiet_m_ = 0.0F;  ///< change within these
  bool was_stuck_ = false;
  bool repeats_ = false;
  bool is_too_quiet_ = false;
};

}  // namespace odoless
