#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace odoless {

/// One of the scans that a laser knows.
struct RplidarMode {
  std::string_view name;
  double sample_us = 0.0;
  double range_max_m = 0.0;  ///< that it promises
  int answer_type = 0;       ///< of its packets
};

/// A laser that speaks RPLIDAR's protocol.
struct RplidarModel {
  std::string_view name;  ///< as in drivers/lrf/models.hpp, where it is there
  std::string_view product;
  int id = 0;  ///< what it says to be: series and model, 4 bits each
  int firmware_major = 1;
  int firmware_minor = 0;
  int hardware = 0;
  std::int64_t turn_ns = 0;
  int baud = 0;
  double range_far_m = 0.0;  ///< what it really sees
  double range_sd_m = 0.0;   ///< standard deviation of one range
  int rpm_min = 0;
  int rpm_max = 0;
  int motor_duty = 0;  ///< at which it turns at its usual speed; 0: its motor takes no duty
  std::span<const RplidarMode> modes;
  std::size_t usual_mode = 0;

  [[nodiscard]] int series() const { return id >> 4; }
  [[nodiscard]] bool triangulates() const { return series() < 4; }
  /// The express scan, and what a sample takes.
  [[nodiscard]] bool knows_express() const { return !triangulates() || firmware_minor >= 17; }
  /// Questions for single settings.
  [[nodiscard]] bool knows_configuration() const { return !triangulates() || firmware_minor >= 24; }
  /// Its motor takes its speed, and turns by itself at first.
  [[nodiscard]] bool takes_speed() const { return series() >= 6; }
  [[nodiscard]] int usual_rpm() const { return static_cast<int>(60'000'000'000 / turn_ns); }
};

[[nodiscard]] std::span<const RplidarModel> rplidar_models();

/// The model of that name, or null.
[[nodiscard]] const RplidarModel* find_rplidar_model(std::string_view name);

/// Its answer to a question for a setting, without the descriptor: the key and the value. A key or a scan mode that it
/// doesn't know has no value.
[[nodiscard]] std::string rplidar_setting(const RplidarModel& model, std::string_view question);

}  // namespace odoless
