#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/sick/scan_stream.hpp"
#include "tools/emulate/emulated_lrf.hpp"
#include "tools/emulate/sick_output.hpp"

namespace odoless {

/// A laser that speaks the telegrams of the SICK LMS2xx.
struct SickModel {
  std::string_view name;     ///< as in drivers/lrf/models.hpp, where it is there
  std::string_view product;  ///< as it answers when asked for its type
  double range_far_m;        ///< what it really sees
  double range_sd_m;         ///< standard deviation of one range
  sick::Variant variant{};   ///< when it is switched on
};

[[nodiscard]] std::span<const SickModel> sick_models();

/// The model of that name, or null.
[[nodiscard]] const SickModel* find_sick_model(std::string_view name);

/// The beams of a variant and their times: of steps below 1 degree, every turn of the mirror measures a part.
[[nodiscard]] std::vector<EmulatedBeam> sick_beams(const sick::Variant& variant);

/// A laser that speaks the telegrams of the SICK LMS2xx: modes, password, variants, units, line rates; scans, means,
/// parts and single turns, streamed or on request; a reset.
///
/// It starts at 9600 baud; while the line carries one scan, the others are left out, as on the device. Its answers take
/// their time too: it thinks, and the line carries them. After a reset, or without power for a moment, it is deaf for a
/// second and then says that it is on.
class SickDevice final : public EmulatedLrf {
 public:
  /// `source` must outlive it; its scans come at the pace of the mirror's turns.
  SickDevice(const SickModel& model, EmulatedScans& source, EmulatedLrfOptions options);

  /// How often its configuration was written: its memory wears.
  [[nodiscard]] int writes() const { return writes_; }

 protected:
  [[nodiscard]] int baud() const override { return baud_; }

 private:
  void hear(std::string_view bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns(std::int64_t index) const override;
  void on_due(std::int64_t index) override;
  void restart(std::int64_t now_ns) override;

  [[nodiscard]] bool take_request(std::int64_t now_ns);
  void execute(std::string_view payload, std::int64_t now_ns);
  /// Nothing: the answer is a scan that is yet to be measured.
  [[nodiscard]] std::optional<std::string> answer_to(std::string_view payload, std::int64_t now_ns);
  [[nodiscard]] std::string set_mode(std::string_view payload, std::int64_t now_ns);
  /// False: there is no such mode, or not with these parameters.
  [[nodiscard]] bool stream(int mode, std::string_view parameters, std::int64_t now_ns);
  [[nodiscard]] std::optional<std::string> request_once(std::string_view payload, std::int64_t now_ns);
  void power_up();
  void boot(std::int64_t now_ns);
  [[nodiscard]] std::string set_variant(std::string_view payload);
  [[nodiscard]] std::string set_configuration(std::string_view payload);
  [[nodiscard]] std::string state() const;
  /// Adds a scan to what the next telegram tells.
  void collect(std::int64_t index);
  [[nodiscard]] std::string frame(std::int64_t index) const;
  [[nodiscard]] unsigned value(double range_m) const;
  [[nodiscard]] bool streams() const { return output_.has_value(); }
  [[nodiscard]] int part_of(std::int64_t index) const { return static_cast<int>(index % variant_.turns()); }
  [[nodiscard]] bool in_mm() const { return configuration_[6] == 1; }
  [[nodiscard]] std::int64_t transfer_ns() const;
  [[nodiscard]] std::int64_t measured_ns(std::int64_t index) const;

  SickModel model_;
  sick::Variant variant_;
  std::string received_;
  std::string configuration_;  ///< survives a loss of power
  bool installing_ = false;
  int mode_ = 0x25;                   ///< of operation
  std::optional<SickOutput> output_;  ///< what it sends
  bool is_once_ = false;              ///< one telegram of it
  bool resets_ = false;               ///< when it has answered
  int collected_ = 0;                 ///< scans for the next telegram
  std::int64_t deaf_until_ns_ = 0;
  int baud_ = 9600;
  int next_baud_ = 9600;            ///< from the next round on: the answer still goes at the old rate
  std::int64_t line_free_ns_ = 0;   ///< when what was sent before has been carried
  std::int64_t next_start_ns_ = 0;  ///< the scan before takes all turns until then
  int writes_ = 0;
  std::vector<EmulatedBeam> beams_;
  std::vector<double> ranges_m_;
  std::vector<double> sums_m_;  ///< of the scans collected
};

}  // namespace odoless
