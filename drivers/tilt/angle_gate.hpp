#pragma once

#include <cstdint>

namespace odoless {

/// Refuses angles that the axis cannot have come to: what a check sum let through, or a bus without one.
///
/// Thread: one thread. Real time: a few steps per call.
class AngleGate {
 public:
  /// @param speed_max_radps  Fastest that the axis can move, pushed or not.
  explicit AngleGate(double speed_max_radps) : speed_max_radps_(speed_max_radps) {}

  /// Whether the angle fits the ones before. After a few that fit each other but not those, these are believed.
  [[nodiscard]] bool passes(std::int64_t stamp_ns, double angle_rad);

  /// Forgets: any angle may come next.
  void restart() { *this = AngleGate(speed_max_radps_); }

 private:
  [[nodiscard]] bool follows(std::int64_t stamp_ns, double angle_rad, std::int64_t before_ns, double before_rad) const;

  static constexpr int kConfirmations = 5;
  static constexpr double kSlackRad = 0.02;

  double speed_max_radps_;
  bool started_ = false;
  std::int64_t last_ns_ = 0;
  double last_rad_ = 0.0;
  int suspects_ = 0;  ///< in a row that fit each other
  std::int64_t suspect_ns_ = 0;
  double suspect_rad_ = 0.0;
};

}  // namespace odoless
