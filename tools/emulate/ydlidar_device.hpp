#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/emulate/emulated_lrf.hpp"

namespace odoless {

/// A laser that sends YDLIDAR's packets.
struct YdlidarModel {
  std::string_view name;  ///< as in drivers/lrf/models.hpp
  std::string_view product;
  int id;
  std::int64_t turn_ns;
  int samples_per_s;
  int baud;
  bool takes_commands;  ///< or it streams as soon as it has power
  bool triangulates;    ///< or it measures the time of flight
  double range_far_m;   ///< what it really sees
  double range_sd_m;    ///< standard deviation of one range
};

[[nodiscard]] std::span<const YdlidarModel> ydlidar_models();

/// The model of that name, or null.
[[nodiscard]] const YdlidarModel* find_ydlidar_model(std::string_view name);

/// A laser that speaks YDLIDAR's protocol: scan, stop, restart, information and health, or none of them.
///
/// It samples evenly and sends packets of up to 40 samples; where its mirror passes the zero, a packet of that sample
/// alone. The angles are the mirror's: one that triangulates has seen what lies up to 8 degrees behind it.
class YdlidarDevice final : public EmulatedLrf {
 public:
  /// `source` must outlive it; its scans are the turns.
  YdlidarDevice(const YdlidarModel& model, EmulatedScans& source, EmulatedLrfOptions options);

 protected:
  [[nodiscard]] int baud() const override { return model_.baud; }

 private:
  void hear(std::string_view bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns(std::int64_t piece) const override;
  void on_due(std::int64_t piece) override;
  void restart(std::int64_t now_ns) override;

  void execute(unsigned char command, std::int64_t now_ns);
  void stream(std::int64_t now_ns);
  [[nodiscard]] std::string information() const;

  [[nodiscard]] std::int64_t sample_time_ns(std::int64_t index) const;
  [[nodiscard]] double mirror_deg(std::int64_t index) const;
  void measure_turn(std::int64_t turn);
  [[nodiscard]] unsigned sample(std::int64_t index);
  /// The packet of these samples.
  [[nodiscard]] std::string packet(std::int64_t first, std::span<const unsigned> samples, bool starts_turn) const;

  YdlidarModel model_;
  std::string received_;
  bool streams_;
  std::int64_t turn_ = -1;       ///< that is measured
  std::int64_t turn_begin_ = 0;  ///< its first sample
  std::vector<EmulatedBeam> beams_;
  std::vector<double> ranges_m_;
};

}  // namespace odoless
