#pragma once

#include <array>
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

inline std::array<double, 25> example_matrix(double first) {
  std::array<double, 25> matrix{};
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    matrix[i] = first * static_cast<double>(i + 1);
  }
  return matrix;
}

inline MotionRecord example_motion() {
  return {.from_stamp_ns = 1'700'000'000'098'456'000,
          .to_stamp_ns = 1'700'000'000'123'456'000,
          .previous_T_current = {0.025, -0.001, 0.01},
          .odom_T_scan = {12.5, -3.25, 2.0},
          .covariance = {1e-6, 1e-8, -1e-9, 1e-8, 2e-6, 0.0, -1e-9, 0.0, 3e-7},
          .error_carried = example_matrix(0.125),
          .error_added = example_matrix(1e-7),
          .information_1_m2 = {120.0, -0.01},
          .fitness = 0.8,
          .second_peak_ratio = 0.4,
          .evaluations = 4200,
          .flags = kMatched | kConverged};
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
  health.lrf.accepted = 12345;
  health.stages[kFilterStage].p99_ms = 7.5;
  health.storage_error = 28;
  health.cloud = CloudHealth{.points = 5000, .used = 0.25, .refused = 3, .scans_left_out = 4};
  return health;
}

}  // namespace odoless::test
