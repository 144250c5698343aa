#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/parameters.hpp"
#include "core/base/result.hpp"
#include "core/geometry/pose2.hpp"
#include "core/geometry/velocity2.hpp"
#include "core/scan/scan_time.hpp"

namespace odoless {

/// What a beam says.
enum class BeamState : std::uint8_t {
  kReturn,    ///< a surface at range_m
  kNoReturn,  ///< nothing within the laser's range, or a surface that swallowed the beam
  kInvalid,   ///< nothing can be said: NaN, zero, negative, nearer than the gate
};

struct ScanParams {
  int beams_max = 2048;
  double range_min_m = 0.05;
  double range_max_m = 30.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("beams_max", self.beams_max, Range{8, 16384},
                "Most beams that a scan may have; memory is set aside for them.");
    visit.value("range_min_m", self.range_min_m, Range{0.0, 10.0},
                "Shortest range of a return; nearer ones are taken for the robot itself and ignored.");
    visit.value("range_max_m", self.range_max_m, Range{0.5, 200.0},
                "Longest range of a return; farther ones count as no return.");
  }
};

/// One sweep as a device or a log tells it; a view, valid while its owner keeps the ranges.
struct RawScan {
  std::int64_t stamp_ns = 0;  ///< monotonic
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;      ///< positive: counter-clockwise
  std::int64_t first_beam_ns = 0;   ///< of the first beam in the list, after the stamp
  std::int64_t beam_period_ns = 0;  ///< from beam to beam, < 0 where the last was first; 0: unknown, or all at once
  float no_return_m = std::numeric_limits<float>::infinity();  ///< the device's code: this range or more is no return
  std::span<const float> ranges_m{};
};

/// One laser scan, checked: per-beam state and angle in the scan frame (the laser's, x forward, y left).
///
/// Any number of beams up to the capacity, any start angle and step. Memory is fixed at construction.
/// Thread: owned by one thread. Real time: `assign` does not allocate; its time is linear in the beams.
class ScanFrame {
 public:
  explicit ScanFrame(const ScanParams& params);

  /// Classifies every beam of `raw`. Leaves the frame as it was on an error:
  /// Errc::kTooManyBeams, or Errc::kBadGeometry (angle not finite, step of zero).
  [[nodiscard]] Errc assign(const RawScan& raw);

  /// Puts every beam where it would have been seen from the laser's pose at the stamp, for a laser that moved at
  /// `velocity` meanwhile; beam `i` was measured `i` beam periods after the first. Does nothing where the scan tells no
  /// beam period, or one that is too long to tell anything. Once per `assign`; linear in the beams, no allocation.
  void deskew(const Velocity2& velocity);
  /// How long the sweep took of which the motion was taken out; 0: none was.
  [[nodiscard]] double deskewed_s() const { return deskewed_s_; }

  /// With which speed.
  [[nodiscard]] const Velocity2& deskewed_with() const { return deskewed_with_; }

  /// When the scan was taken, by a ScanClock; until it is told, that is the stamp.
  void set_time(const ScanTime& time) { time_ = time; }

  /// The scan's stamp as it was told: what it is known by.
  [[nodiscard]] std::int64_t stamp_ns() const { return stamp_ns_; }
  /// When it was taken; of a stream of scans these grow.
  [[nodiscard]] std::int64_t time_ns() const { return time_.time_ns; }
  /// Standard deviation of `time_ns` against the scans about it (ScanTime).
  [[nodiscard]] double time_sd_s() const { return time_.sd_s; }
  /// For how long, up to the scan before, the laser showed an older one, which tells nothing of its time; 0 from
  /// `assign` on.
  [[nodiscard]] double unobserved_s() const { return unobserved_s_; }
  void set_unobserved_s(double unobserved_s) { unobserved_s_ = unobserved_s; }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int returns() const { return returns_; }
  [[nodiscard]] double angle_rad(int beam) const { return start_angle_rad_ + beam * angle_step_rad_; }
  [[nodiscard]] double angle_step_rad() const { return angle_step_rad_; }
  [[nodiscard]] BeamState state(int beam) const { return states_[static_cast<std::size_t>(beam)]; }
  [[nodiscard]] bool is_return(int beam) const { return state(beam) == BeamState::kReturn; }
  /// Range of a return; 0 for every other beam.
  [[nodiscard]] double range_m(int beam) const { return ranges_m_[static_cast<std::size_t>(beam)]; }
  /// Unit vector of the beam in the scan frame.
  [[nodiscard]] Point2 direction(int beam) const { return directions_[static_cast<std::size_t>(beam)]; }
  /// End point of a return in the scan frame.
  [[nodiscard]] Point2 point(int beam) const {
    const Point2 d = direction(beam);
    return {range_m(beam) * d.x_m, range_m(beam) * d.y_m};
  }
  [[nodiscard]] double range_max_m() const { return params_.range_max_m; }

 private:
  void set_geometry(const RawScan& raw);

  ScanParams params_;
  std::int64_t stamp_ns_ = 0;
  ScanTime time_{};
  double unobserved_s_ = 0.0;
  double start_angle_rad_ = 0.0;
  double angle_step_rad_ = 0.0;
  std::int64_t first_beam_ns_ = 0;
  std::int64_t beam_period_ns_ = 0;
  double deskewed_s_ = 0.0;
  Velocity2 deskewed_with_{};
  int size_ = 0;
  int returns_ = 0;
  int directions_valid_ = 0;
  std::vector<float> ranges_m_;
  std::vector<BeamState> states_;
  std::vector<Point2> directions_;
};

}  // namespace odoless
