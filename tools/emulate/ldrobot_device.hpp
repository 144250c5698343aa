#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/emulate/emulated_lrf.hpp"

namespace odoless {

/// A laser that sends LDROBOT's packets.
struct LdrobotModel {
  std::string_view name;  ///< as in drivers/lrf/models.hpp
  std::string_view product;
  std::int64_t turn_ns;
  int samples_per_s;
  int baud;
  double range_far_m;  ///< what it really sees
  double range_sd_m;   ///< standard deviation of one range
};

[[nodiscard]] std::span<const LdrobotModel> ldrobot_models();

/// The model of that name, or null.
[[nodiscard]] const LdrobotModel* find_ldrobot_model(std::string_view name);

/// A laser that sends LDROBOT's packets of twelve points from the moment that it has power, whoever listens; it takes
/// no commands. Its clock counts milliseconds up to 30 s.
class LdrobotDevice final : public EmulatedLrf {
 public:
  /// `source` must outlive it; its scans are the turns. Its time starts at once.
  LdrobotDevice(const LdrobotModel& model, EmulatedScans& source, EmulatedLrfOptions options);

 protected:
  [[nodiscard]] int baud() const override { return model_.baud; }

 private:
  void hear(std::string_view /*bytes*/, std::int64_t /*now_ns*/) override {}
  [[nodiscard]] std::int64_t due_ns(std::int64_t piece) const override;
  void on_due(std::int64_t piece) override;
  void restart(std::int64_t now_ns) override;
  void set_drift(double drift_ppm, std::int64_t now_ns) override;
  /// By its own clock, since it has power.
  [[nodiscard]] double clock_ns(std::int64_t now_ns) const;

  [[nodiscard]] std::int64_t sample_time_ns(std::int64_t index) const;
  [[nodiscard]] std::int64_t turn_of(std::int64_t index) const;
  [[nodiscard]] double mirror_deg(std::int64_t index) const;
  [[nodiscard]] double range_m(std::int64_t index);
  void measure_turn(std::int64_t turn);

  LdrobotModel model_;
  std::int64_t clock_host_ns_ = 0;  ///< its clock was set or changed its pace then ...
  double clock_device_ns_ = 0.0;    ///< ... and showed this
  double drift_ppm_ = 0.0;
  std::int64_t turn_ = -1;       ///< that is measured
  std::int64_t turn_begin_ = 0;  ///< its first sample
  std::vector<EmulatedBeam> beams_;
  std::vector<double> ranges_m_;
};

}  // namespace odoless
