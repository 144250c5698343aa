#pragma once

#include <array>
#include <cstdint>

#include "core/base/rng.hpp"
#include "tests/support/simulated_scene.hpp"

namespace odoless {

/// What makes work for a matcher: no pose better than another, every cell touched, every scan tried again.
enum class HardScans : std::uint8_t { kCircle, kNoise, kFoliage, kOneRange, kFar, kAlternating, kRoom };
inline constexpr std::array<const char*, 7> kHardScanNames{
    "circle", "white noise", "foliage", "all at one range", "2048 beams at 30 m", "alternating scenes", "room"};

/// Scans of a robot that wanders and turns, one after the other; 1081 beams over 270 deg.
class HardScanSource {
 public:
  static constexpr std::int64_t kPeriod_ns = 100'000'000;

  HardScanSource(HardScans kind, std::uint64_t seed) : kind_(kind), rng_(seed) {}

  [[nodiscard]] ScanFrame next();

 private:
  [[nodiscard]] ScanFrame scan(HardScans kind, const Pose2& map_T_scan, std::int64_t stamp_ns);
  [[nodiscard]] float range_m(HardScans kind, const Pose2& map_T_scan, double angle_rad);

  HardScans kind_;
  Rng rng_;
  SimulatedScene room_ = cluttered_room();
  int count_ = 0;
};

}  // namespace odoless
