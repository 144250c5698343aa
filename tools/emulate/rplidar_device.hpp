#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/emulate/emulated_lrf.hpp"
#include "tools/emulate/rplidar_model.hpp"
#include "tools/emulate/rplidar_packets.hpp"

namespace odoless {

/// A laser that speaks RPLIDAR's protocol: stop, reset, information, health, settings, sample times, motor, and the
/// scans of its list of modes, each from the firmware on that knows it.
///
/// It samples evenly whatever its mirror does, so that the number of points in a turn varies. Points are sent some at a
/// time, or in capsules. If it triangulates, its mirror is 8 degrees past a far point and less past a near one, which
/// is taken off the angles of points, but not where nothing answered. An A2 or A3 is still until its motor has a duty,
/// an S where its speed was set to 0.
class RplidarDevice final : public EmulatedLrf {
 public:
  /// `source` must outlive it; its scans are the turns.
  RplidarDevice(const RplidarModel& model, EmulatedScans& source, EmulatedLrfOptions options);

  [[nodiscard]] int motor_duty() const { return motor_duty_; }
  /// 0: it stands, for it was told to.
  [[nodiscard]] int speed_rpm() const { return speed_rpm_; }

 protected:
  [[nodiscard]] int baud() const override { return model_.baud; }

 private:
  void hear(std::string_view bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns(std::int64_t piece) const override;
  void on_due(std::int64_t piece) override;
  void restart(std::int64_t now_ns) override;

  [[nodiscard]] bool take_request(std::int64_t now_ns);
  void execute(int command, std::string_view payload, std::int64_t now_ns);
  void stream(std::size_t mode, std::int64_t now_ns);
  void express(std::string_view payload, std::int64_t now_ns);
  [[nodiscard]] std::string information() const;
  [[nodiscard]] std::string sample_times() const;
  [[nodiscard]] bool turns() const;

  [[nodiscard]] std::int64_t sample_ns() const;
  [[nodiscard]] std::int64_t samples_per_piece() const;
  [[nodiscard]] double compensation_deg(double range_m) const;
  [[nodiscard]] RplidarSample sample(std::int64_t index);
  void measure_turn(std::int64_t turn);
  [[nodiscard]] double mirror_deg(std::int64_t index) const;

  RplidarModel model_;
  std::string received_;
  std::optional<std::size_t> mode_;                 ///< of its list; none: it is idle
  const rplidar::CapsuleFormat* format_ = nullptr;  ///< null: nodes
  int motor_duty_ = 0;
  int speed_rpm_;
  bool is_first_capsule_ = false;
  std::int64_t turn_ = -1;       ///< that is measured
  std::int64_t turn_begin_ = 0;  ///< its first sample
  std::vector<EmulatedBeam> beams_;
  std::vector<double> ranges_m_;
  std::vector<double> compensations_deg_;  ///< of the beams
};

}  // namespace odoless
