#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace odoless {

/// A laser that speaks RPLIDAR's protocol.
struct RplidarModel {
  std::string_view name;  ///< as in drivers/lrf/models.hpp, where it is there
  std::string_view product;
  int firmware_minor;  ///< of 1.x: what it knows hangs on that
  int id;              ///< what it says to be
  std::int64_t turn_ns;
  int sample_us;  ///< of the standard scan
  int express_sample_us;
  int baud;
  double range_far_m;  ///< what it really sees
  double range_sd_m;   ///< standard deviation of one range
  int rpm_min;
  int rpm_max;
  int motor_duty;  ///< at which it turns at its usual speed; 0: its motor takes no command

  /// The express scan, and what a sample takes.
  [[nodiscard]] bool knows_express() const { return firmware_minor >= 17; }
  /// Questions for single settings.
  [[nodiscard]] bool knows_configuration() const { return firmware_minor >= 24; }
  [[nodiscard]] int usual_rpm() const { return static_cast<int>(60'000'000'000 / turn_ns); }
};

[[nodiscard]] std::span<const RplidarModel> rplidar_models();

/// The model of that name, or null.
[[nodiscard]] const RplidarModel* find_rplidar_model(std::string_view name);

/// Its answer to a question for a setting, without the descriptor: the key and the value. A key or a scan mode that it
/// doesn't know has no value.
[[nodiscard]] std::string rplidar_setting(const RplidarModel& model, std::string_view question);

}  // namespace odoless
