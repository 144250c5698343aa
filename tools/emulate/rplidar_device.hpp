#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/emulate/emulated_lrf.hpp"
#include "tools/emulate/rplidar_model.hpp"

namespace odoless {

/// A laser that speaks RPLIDAR's protocol: stop, reset, information, health, settings, sample times, motor, standard
/// and express scan, each from the firmware on that knows it.
///
/// It samples evenly whatever its mirror does, so that the number of points in a turn varies. Points are sent eight at
/// a time, or a capsule of 32. As it triangulates, its mirror is 7 degrees past a far point and less past a near one;
/// it takes that off the angles of points, but not where nothing answered. An A2 is still until its motor has a duty.
class RplidarDevice final : public EmulatedLrf {
 public:
  /// `source` must outlive it; its scans are the turns.
  RplidarDevice(const RplidarModel& model, EmulatedScans& source, EmulatedLrfOptions options);

  [[nodiscard]] int motor_duty() const { return motor_duty_; }

 protected:
  [[nodiscard]] int baud() const override { return model_.baud; }

 private:
  enum class Mode : std::uint8_t { kIdle, kStandard, kExpress };

  void hear(std::string_view bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns(std::int64_t piece) const override;
  void on_due(std::int64_t piece) override;
  void restart(std::int64_t now_ns) override;

  [[nodiscard]] bool take_request(std::int64_t now_ns);
  void execute(int command, std::string_view payload, std::int64_t now_ns);
  void stream(Mode mode, std::string_view descriptor, std::int64_t now_ns);

  /// One sample: where the mirror was, and what was seen.
  struct Sample {
    double mirror_deg = 0.0;        ///< clockwise
    double compensation_deg = 0.0;  ///< by which it is past what was seen
    double range_m = 0.0;           ///< 0: nothing answered
    bool starts_turn = false;       ///< the mirror's
    bool completes_scan = false;    ///< the first one after a scan of the source
  };
  [[nodiscard]] std::int64_t sample_ns() const;
  [[nodiscard]] std::int64_t samples_per_piece() const { return mode_ == Mode::kExpress ? 32 : 8; }
  [[nodiscard]] Sample sample(std::int64_t index);
  void measure_turn(std::int64_t turn);
  [[nodiscard]] double mirror_deg(std::int64_t index) const;
  [[nodiscard]] static std::string nodes(std::span<const Sample> samples);
  [[nodiscard]] std::string capsule(std::span<const Sample> samples);

  RplidarModel model_;
  std::string received_;
  Mode mode_ = Mode::kIdle;
  int motor_duty_ = 0;
  bool is_first_capsule_ = false;
  std::int64_t turn_ = -1;       ///< that is measured
  std::int64_t turn_begin_ = 0;  ///< its first sample
  std::vector<EmulatedBeam> beams_;
  std::vector<double> ranges_m_;
  std::vector<double> compensations_deg_;  ///< of the beams
};

}  // namespace odoless
