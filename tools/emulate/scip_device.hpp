#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/emulate/emulated_lrf.hpp"
#include "tools/emulate/scan_request.hpp"
#include "tools/emulate/scip_model.hpp"

namespace odoless {

/// A laser that speaks SCIP 2.0. Knows every command of the protocol that a client needs. Rebooted (RB, twice within a
/// second) it is deaf for two seconds.
class ScipDevice final : public EmulatedLrf {
 public:
  /// `source` must outlive it.
  ScipDevice(const ScipModel& model, EmulatedScans& source, EmulatedLrfOptions options, std::int64_t now_ns);

 private:
  void hear(std::string_view bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns(std::int64_t index) const override;
  void on_due(std::int64_t index) override;
  void restart(std::int64_t now_ns) override;
  void set_drift(double drift_ppm, std::int64_t now_ns) override;
  [[nodiscard]] int baud() const override { return is_on_rs232_ ? baud_ : 0; }

  void execute(const std::string& line, std::int64_t now_ns);
  [[nodiscard]] std::string reply_to(const std::string& line, std::int64_t now_ns);
  [[nodiscard]] std::string reply_to_time(const std::string& line, std::int64_t now_ns);
  [[nodiscard]] std::string reply_to_reboot(const std::string& line, std::int64_t now_ns);
  /// What every laser answers always, and the newer ones in time mode, too.
  [[nodiscard]] std::optional<std::string> told_of_itself(const std::string& line, std::int64_t now_ns) const;
  [[nodiscard]] std::string status_of_setting(const std::string& line);
  [[nodiscard]] std::string version() const;
  [[nodiscard]] std::string parameters() const;
  [[nodiscard]] std::string state(std::int64_t now_ns) const;
  [[nodiscard]] std::string scan_reply(const std::string& line, std::int64_t now_ns);
  /// When the last beam is measured; the line has yet to carry the scan.
  [[nodiscard]] std::int64_t measured_ns(std::int64_t index) const;
  [[nodiscard]] std::int64_t transfer_ns() const;
  [[nodiscard]] std::string frame(const scip::ScanRequest& request, std::string_view head, std::int64_t index);
  [[nodiscard]] std::uint32_t value_mm(std::size_t first_beam, std::size_t count) const;
  [[nodiscard]] std::uint32_t code_of(double range_m) const;
  /// All that one beam saw, the nearest first: two things where it hit an edge.
  [[nodiscard]] std::vector<std::uint32_t> echoes_mm(std::size_t beam) const;

  void send_scan(std::int64_t index);
  void reset_state(bool is_power_up);
  [[nodiscard]] std::uint32_t counter_ms(std::int64_t now_ns) const;

  ScipModel model_;
  std::string line_;
  std::vector<EmulatedBeam> beams_;
  std::vector<double> ranges_m_;

  std::optional<scip::ScanRequest> stream_;
  int left_ = 0;     ///< scans of a stream with an end
  int skipped_ = 0;  ///< since the last one sent

  bool in_scip1_ = false;
  bool laser_on_ = false;
  bool in_time_mode_ = false;
  bool is_on_rs232_;
  int baud_;
  std::optional<std::int64_t> first_reboot_ns_;  ///< when it was asked for the first of two times
  std::int64_t deaf_until_ns_ = 0;
  std::int64_t line_free_ns_ = 0;  ///< a scan that is measured before is left out

  std::int64_t clock_host_ns_;    ///< the device's clock was set or changed its pace then ...
  double clock_device_ns_ = 0.0;  ///< ... and showed this
  double drift_ppm_ = 0.0;
};

}  // namespace odoless
