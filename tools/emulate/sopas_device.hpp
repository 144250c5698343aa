#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/lrf/sopas/scan_data.hpp"
#include "drivers/lrf/sopas/telegram.hpp"
#include "tools/emulate/emulated_lrf.hpp"

namespace odoless {

/// A laser that speaks SOPAS.
struct SopasModel {
  std::string_view name;  ///< as in drivers/lrf/models.hpp
  std::string_view product;
  std::string_view ident;  ///< type and firmware, as DeviceIdent has them
  sopas::Dialect dialect;  ///< the one that it is set to
  std::int64_t scan_ns;    ///< from scan to scan
  int steps_per_deg;       ///< after power-up
  std::int32_t first_tmdeg = -450'000;
  std::int32_t last_tmdeg = 2'250'000;
  int scans_per_turn = 1;     ///< more than one: its mirror has so many faces
  double mm_per_count = 1.0;  ///< of a range
  bool has_settings;          ///< of rate and step: LMS1xx; a TiM has one of each
  bool needs_login;           ///< for what a scan holds
  bool is_stamped_at_end;     ///< of the scan, and not at the mirror's zero index before it
  double range_near_m = 0.0;  ///< what it really sees
  double range_far_m;
  double range_sd_m;  ///< standard deviation of one range
};

[[nodiscard]] std::span<const SopasModel> sopas_models();

/// The model of that name, or null.
[[nodiscard]] const SopasModel* find_sopas_model(std::string_view name);

/// A laser that speaks SOPAS in one dialect, and is deaf to the other: log-in, settings of rate, step, part and content
/// of a scan, single scans and a stream of them. What it does not know, it refuses with the code for it.
class SopasDevice final : public EmulatedLrf {
 public:
  /// `source` must outlive it; its scans are the turns of the fastest setting.
  SopasDevice(const SopasModel& model, EmulatedScans& source, EmulatedLrfOptions options, std::int64_t now_ns);

 private:
  /// What a client can set.
  struct Settings {
    int turns_per_scan = 1;  ///< of the source: 2 is half the rate
    int steps_per_deg = 1;
    std::int32_t start_tmdeg = 0;
    std::int32_t stop_tmdeg = 0;
    bool has_remission = false;
    unsigned scans_per_telegram = 1;
  };

  void hear(std::string_view bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns(std::int64_t piece) const override;
  void on_due(std::int64_t piece) override;
  void restart(std::int64_t now_ns) override;
  void set_drift(double drift_ppm, std::int64_t now_ns) override;

  void execute(const sopas::Telegram& telegram, std::int64_t now_ns);
  void read_variable(std::string_view name, std::int64_t now_ns);
  void write_variable(std::string_view name, sopas::Fields fields, std::int64_t now_ns);
  void call_method(std::string_view name, sopas::Fields fields, std::int64_t now_ns);
  [[nodiscard]] int set_scan(sopas::Fields& fields, std::int64_t now_ns);
  [[nodiscard]] bool set_content(sopas::Fields& fields);
  [[nodiscard]] bool set_part(sopas::Fields& fields);
  void refuse(int code, std::int64_t now_ns);

  [[nodiscard]] Settings settings_at_power_up() const {
    return {.steps_per_deg = model_.steps_per_deg, .start_tmdeg = model_.first_tmdeg, .stop_tmdeg = model_.last_tmdeg};
  }
  [[nodiscard]] std::int64_t scan_ns() const { return model_.scan_ns * settings_.turns_per_scan; }
  /// From the zero index of the mirror to that angle.
  [[nodiscard]] std::int64_t since_zero_ns(double sick_deg) const;
  [[nodiscard]] std::int64_t scan_start_ns(std::int64_t piece) const;
  [[nodiscard]] std::string scan_telegram(std::string_view head, std::int64_t piece);
  [[nodiscard]] std::uint32_t clock_us(std::int64_t now_ns) const;

  SopasModel model_;
  sopas::TelegramReader reader_{1024};
  Settings settings_;
  bool is_logged_in_ = false;
  bool is_streaming_ = false;
  std::uint32_t telegrams_ = 0;
  std::vector<EmulatedBeam> beams_;
  std::vector<double> ranges_m_;

  std::int64_t clock_host_ns_;  ///< its clock was set or changed its pace then ...
  double clock_device_ns_;      ///< ... and showed this
  double drift_ppm_ = 0.0;
};

}  // namespace odoless
