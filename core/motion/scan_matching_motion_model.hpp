#pragma once

#include <numbers>

#include "core/base/parameters.hpp"
#include "core/base/rng.hpp"
#include "core/geometry/pose2.hpp"

namespace odoless {

/// Constants of the scan-matching motion model; the defaults are those of the dissertation's Table 5.1 and 5.3.
/// A spread is the argument v of the table's sampleA, whose deviation is v / 3.
struct MotionModelParams {
  double translation_spread_m = 0.02;
  double translation_spread_ratio = 0.1;
  double rotation_spread_rad = 0.5 * std::numbers::pi / 180.0;
  double rotation_spread_ratio = 0.1;
  double slip_probability = 0.05;
  double slip_rotation_max_rad = 3.0 * std::numbers::pi / 180.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("translation_spread_m", self.translation_spread_m, Range{0.0, 10.0},
                "Constant part of the noise of a displacement along each axis (v in Table 5.1; the standard deviation "
                "is v / 3).");
    visit.value("translation_spread_ratio", self.translation_spread_ratio, Range{0.0, 10.0},
                "Noise of a displacement per metre along the same axis.");
    visit.value("rotation_spread_rad", self.rotation_spread_rad, Range{0.0, 3.2},
                "Constant part of the noise of a rotation (the standard deviation is a third).");
    visit.value("rotation_spread_ratio", self.rotation_spread_ratio, Range{0.0, 10.0},
                "Noise of a rotation per radian.");
    visit.value(
        "slip_probability", self.slip_probability, Range{0.0, 1.0},
        "Probability that the match missed the travel that the last speed predicts, as along a featureless wall.");
    visit.value("slip_rotation_max_rad", self.slip_rotation_max_rad, Range{0.0, 3.2},
                "Largest rotation of a match that may have missed travel.");
  }
};

/// Draws where the robot may be after a scan match reported a displacement: Tables 5.1 to 5.3 of the dissertation.
///
/// Each axis gets independent, nearly Gaussian noise (sampleA: v/6 times the sum of 12 uniforms of [-1, 1), so mean 0,
/// deviation v/3, never beyond 2v). With `slip_probability`, and only if the match turned by less than
/// `slip_rotation_max_rad`, the noise along the heading is replaced by a lobe of mean lambda and deviation lambda/6
/// (sampleB with v = lambda/2): the match along a featureless wall that reports almost no travel.
///
/// Frames:    the table's robot looks along y: its (dx, dy) is (-dy, dx) of the product's x-forward frame.
/// Thread:    immutable, any thread; the generator belongs to the caller.
/// Real time: no allocation; exactly 37 numbers are drawn per sample, slip or not.
class ScanMatchingMotionModel {
 public:
  explicit ScanMatchingMotionModel(const MotionModelParams& params);

  /// @param map_T_previous  Pose before the motion.
  /// @param increment       previous_T_current as matched.
  /// @param lambda_m        Travel that the robot's last speed promises for this step, >= 0
  /// (core/motion/travel_speed.hpp).
  /// @return                map_T_current, one draw.
  [[nodiscard]] Pose2 sample(const Pose2& map_T_previous, const Pose2& increment, double lambda_m, Rng& rng) const;

 private:
  MotionModelParams params_;
};

}  // namespace odoless
