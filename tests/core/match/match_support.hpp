#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "core/match/ndt_matcher.hpp"
#include "tests/support/simulated_scene.hpp"

namespace odoless {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Two scans of a scene, and the truth.
struct ScanPair {
  ScanFrame reference;
  ScanFrame scan;
  Pose2 reference_T_scan;
};

/// Where a robot may stand in `scene`: 0.3 m from every wall, near the middle.
[[nodiscard]] inline Pose2 random_free_pose(const SimulatedScene& scene, Rng& rng) {
  Pose2 pose;
  do {
    pose = {rng.uniform(-2.2, 2.2), rng.uniform(-1.8, 1.8), rng.uniform(-3.1, 3.1)};
  } while (scene.clearance_m({pose.x_m, pose.y_m}) < 0.3);
  return pose;
}

/// Motions in a box, but not shorter or with less rotation than these.
struct MotionBounds {
  double half_m = 2.0;
  double half_rad = 85.0 * kRadPerDeg;
  double least_m = 0.0;
  double least_rad = 0.0;

  [[nodiscard]] bool hold(const Pose2& motion) const {
    return std::abs(motion.x_m) < half_m && std::abs(motion.y_m) < half_m && std::abs(motion.yaw_rad) < half_rad &&
           std::hypot(motion.x_m, motion.y_m) >= least_m && std::abs(motion.yaw_rad) >= least_rad;
  }
};

/// A pair of scans whose motion keeps the bounds.
[[nodiscard]] inline ScanPair random_pair(const SimulatedScene& scene, const SimulatedLaser& laser,
                                          const MotionBounds& bounds, Rng& rng) {
  while (true) {
    const Pose2 map_T_reference = random_free_pose(scene, rng);
    const Pose2 map_T_scan = random_free_pose(scene, rng);
    const Pose2 motion = map_T_reference.inverse() * map_T_scan;
    if (bounds.hold(motion)) {
      return {sweep(scene, laser, map_T_reference, rng), sweep(scene, laser, map_T_scan, rng), motion};
    }
  }
}

/// A matcher with its reference and generator, for tests that match once.
class MatchBench {
 public:
  explicit MatchBench(const MatcherParams& params = {}, std::uint64_t seed = 1)
      : reference_(params.reference, 8 * params.points_max), matcher_(params), rng_(seed) {}

  [[nodiscard]] MatchReference& reference() { return reference_; }

  [[nodiscard]] Result<MatchResult> match(const ScanFrame& scan, const Expectation& expected = {},
                                          const Deadline& deadline = {}) {
    return matcher_.match(reference_, scan, expected, deadline, rng_);
  }

  [[nodiscard]] MatchResult match(const ScanFrame& reference, const ScanFrame& scan, const Pose2& map_T_reference = {},
                                  const Expectation& expected = {}) {
    const PlacedScan placed{&reference, map_T_reference};
    ODOLESS_CHECK(reference_.rebuild({&placed, 1}) == Errc::kOk);
    return match(scan, expected).value();
  }

 private:
  MatchReference reference_;
  NdtMatcher matcher_;
  Rng rng_;
};

[[nodiscard]] inline double rotation_error_rad(const Pose2& a, const Pose2& b) {
  return std::abs(wrap_angle(a.yaw_rad - b.yaw_rad));
}

[[nodiscard]] inline bool agree(const Pose2& a, const Pose2& b) {
  return a.distance_m(b) < 0.02 && rotation_error_rad(a, b) < 0.5 * kRadPerDeg;
}

}  // namespace odoless
