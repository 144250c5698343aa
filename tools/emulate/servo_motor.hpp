#pragma once

namespace odoless {

/// A motor that drives an axis along a trapezoid of speed. All in the servo's own units of position.
class ServoMotor {
 public:
  explicit ServoMotor(double position_counts) : position_counts_(position_counts), target_counts_(position_counts) {}

  /// Per second, and per second squared; more than 0.
  void set_profile(double speed_counts_per_s, double slope_counts_per_s2);
  void go_to(double target_counts);
  /// Slows down with that slope and then stays.
  void stop(double slope_counts_per_s2);
  /// Stands at once and stays, as one that is jammed or has lost its power.
  void halt();
  /// Moved from outside, without power.
  void push(double way_counts);
  /// The same place is called otherwise from now on.
  void rename(double position_counts);
  void set_jammed(bool jammed) { jammed_ = jammed; }

  void advance(double elapsed_s);

  [[nodiscard]] double position_counts() const { return position_counts_; }
  [[nodiscard]] double velocity_counts_per_s() const { return velocity_counts_per_s_; }
  [[nodiscard]] double target_counts() const { return target_counts_; }
  [[nodiscard]] bool is_there() const;

 private:
  void step(double elapsed_s);

  double position_counts_;
  double velocity_counts_per_s_ = 0.0;
  double target_counts_;
  double speed_counts_per_s_ = 1.0;
  double slope_counts_per_s2_ = 1.0;
  bool stopping_ = false;
  bool jammed_ = false;
};

}  // namespace odoless
