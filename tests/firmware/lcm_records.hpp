#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "firmware/lcm/lcm_link.hpp"

namespace odoless::test {

/// Keeps what a link hands to its tap.
class KeepingTap : public LcmTap {
 public:
  struct Kept {
    std::string channel;
    std::vector<std::byte> message;
    std::int64_t stamp_ns;
  };
  void record(std::string_view channel, std::span<const std::byte> message, std::int64_t stamp_ns) override {
    kept.push_back({std::string(channel), {message.begin(), message.end()}, stamp_ns});
  }
  /// The last message of a channel, decoded by liblcm's generated code.
  template <class Message>
  [[nodiscard]] Message last(const std::string& channel) const {
    Message message{};
    for (auto each = kept.rbegin(); each != kept.rend(); ++each) {
      if (each->channel == channel) {
        const int size_bytes = static_cast<int>(each->message.size());
        if (message.decode(each->message.data(), 0, size_bytes) != size_bytes) {
          break;
        }
        return message;
      }
    }
    ADD_FAILURE() << "no message that decodes on " << channel;
    return message;
  }
  std::vector<Kept> kept;
};

inline ScanRecord example_scan(int beams) {
  return {.stamp_ns = 1'700'000'000'123'456'000,
          .start_angle_rad = static_cast<double>(-2.3561945F),
          .angle_step_rad = static_cast<double>(0.004363323F),
          .beams = beams};
}

inline std::vector<float> example_ranges_m(int beams) {
  std::vector<float> ranges_m(static_cast<std::size_t>(beams));
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    ranges_m[i] = i % 7 == 0 ? std::numeric_limits<float>::infinity() : 0.5F + 0.01F * static_cast<float>(i);
  }
  return ranges_m;
}

/// With every field set.
inline Motion example_motion() {
  const std::int64_t to_stamp_ns = 1'700'000'000'123'456'000;
  Motion motion = Motion::between(to_stamp_ns - 25'000'000, to_stamp_ns, {0.025, -0.001, 0.01});
  motion.duration_sd_s = 0.001;
  motion.odom_T_current = {12.5, -3.25, 2.0};
  for (std::size_t i = 0; i < motion.error_noise.size(); ++i) {
    motion.error_initial[i] = 1e-5 * static_cast<double>(i + 1);
    motion.error_transition[i] = 0.125 * static_cast<double>(i + 1);
    motion.error_noise[i] = 1e-7 * static_cast<double>(i + 1);
  }
  motion.map_slip = {0.0625, 0.015625, 0.015625, 0.03125};
  motion.fitness = 0.8;
  motion.score = 0.7;
  motion.second_peak_ratio = 0.4;
  motion.strong_information_1_m2 = 120.0;
  motion.weak_information_1_m2 = -0.01;
  motion.log_weight = -0.25;
  for (MotionHypothesis& other : motion.alternatives) {
    const double number = ++motion.alternative_count;
    other = {{0.5 * number, 0.01, -0.3}, -number, {1e-4, 1e-6, -1e-6, 1e-6, 2e-4, 1e-7, -1e-6, 1e-7, 3e-5}};
  }
  motion.evaluations = 4200;
  motion.flags = kMotionFlags;
  return motion;
}

inline PoseRecord example_pose() {
  return {.stamp_ns = 1'700'000'000'123'456'000,
          .map_T_scan = {12.0, -3.0, 1.9},
          .map_T_odom = {-0.5, 0.25, -0.1},
          .covariance = {1e-4, 0.0, 0.0, 0.0, 2e-4, 0.0, 0.0, 0.0, 3e-5},
          .update_stamp_ns = 1'700'000'000'000'000'000,
          .update_T_scan = {0.1, 0.0, 0.05},
          .effective_particles = 77.5,
          .log_likelihood_per_beam = -1.25,
          .particles = 100,
          .updated = 1};
}

inline MapTileRecord example_tile(int size_cells) {
  return {.stamp_ns = 1'700'000'000'123'456'000, .column = -3, .row = 2, .size_cells = size_cells, .cell_size_m = 0.05};
}

inline HealthReport example_health() {
  HealthReport health;
  health.stamp_ns = 1'700'000'000'200'000'000;
  health.state = HealthState::kDegraded;
  health.reasons = kReasonBlind | kReasonPaused;
  health.latched_reasons = kReasonBlind | kReasonPaused | kReasonStuck;
  health.lrf.rate_hz = 40.0;
  health.pose_probability = 0.75;
  health.lrf.accepted = 12345;
  health.stages[kFilterStage].p99_ms = 7.5;
  health.storage_error = 28;
  health.graph = GraphHealth{.place = WorldPlaceKnown::kGuessed};
  health.world = WorldHealth{"8a1c", 17, true};
  health.cloud = CloudHealth{.points = 5000, .used = 0.25, .refused = 3, .scans_left_out = 4};
  return health;
}

}  // namespace odoless::test
