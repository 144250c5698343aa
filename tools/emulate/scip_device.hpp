#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/rng.hpp"
#include "tools/emulate/faults.hpp"
#include "tools/emulate/scan_request.hpp"
#include "tools/emulate/scan_source.hpp"
#include "tools/emulate/scip_model.hpp"

namespace odoless {

/// A scan that an emulated laser has sent.
struct SentScan {
  std::int64_t index = 0;          ///< of its source
  std::int64_t first_beam_ns = 0;  ///< when its first beam was measured, on the host's clock
};

/// Bytes that an emulated laser sends at once.
struct SentBytes {
  std::string bytes;
  std::optional<SentScan> scan;
  bool one_by_one = false;
};

struct ScipDeviceOptions {
  std::vector<Fault> faults;
  bool starts_at_once = false;         ///< the source's time starts at construction, not with the first stream
  std::uint32_t counter_start_ms = 0;  ///< of the device's clock at construction
  std::uint64_t seed = 1;              ///< of what garbage is made of
};

/// A laser that speaks SCIP 2.0, without a line: bytes and the host's time come in, bytes go out.
///
/// Its mirror turns all the time; a scan is sent when its last beam has been measured. The source's time starts with
/// the first stream, or at once. Knows every command of the protocol that a client needs; one thread.
class ScipDevice {
 public:
  /// `source` must outlive it.
  ScipDevice(const ScipModel& model, ScanSource& source, ScipDeviceOptions options, std::int64_t now_ns);

  void receive(std::string_view bytes, std::int64_t now_ns);

  /// Sends the scans that are due.
  void tick(std::int64_t now_ns);

  /// When `tick` has something to do next.
  [[nodiscard]] std::int64_t next_event_ns() const;

  /// What is to be sent, in order.
  [[nodiscard]] std::vector<SentBytes> take_output();

  /// The source's time at the host's; nothing before it has started.
  [[nodiscard]] std::optional<std::int64_t> source_time_ns(std::int64_t now_ns) const;

 private:
  void execute(const std::string& line, std::int64_t now_ns);
  [[nodiscard]] std::string reply_to(const std::string& line, std::int64_t now_ns);
  [[nodiscard]] std::string reply_in_time_mode(const std::string& line, std::int64_t now_ns);
  [[nodiscard]] std::string status_of_setting(const std::string& line);
  [[nodiscard]] std::string version() const;
  [[nodiscard]] std::string parameters() const;
  [[nodiscard]] std::string state(std::int64_t now_ns) const;
  [[nodiscard]] std::string scan_reply(const std::string& line, std::int64_t now_ns);
  [[nodiscard]] std::string frame(const scip::ScanRequest& request, std::string_view head, std::int64_t index);
  [[nodiscard]] std::uint32_t value_mm(std::size_t first_beam, std::size_t count) const;

  void start_source(std::int64_t now_ns);
  void measure(std::int64_t index);
  void send_scan(std::int64_t index);
  void damage(std::string& bytes, std::int64_t now_ns);
  void reset_state(bool is_power_up);
  void set_drift(double drift_ppm, std::int64_t now_ns);
  [[nodiscard]] std::uint32_t counter_ms(std::int64_t now_ns) const;
  [[nodiscard]] std::int64_t due_ns(std::int64_t index) const;
  [[nodiscard]] bool fault(FaultKind kind, std::int64_t now_ns) const;
  void follow_faults(std::int64_t now_ns);

  ScipModel model_;
  ScanSource& source_;
  ScipDeviceOptions options_;
  Rng rng_;
  std::string line_;
  std::vector<SentBytes> output_;
  std::vector<double> ranges_m_;

  std::optional<std::int64_t> origin_ns_;  ///< host time of the source's 0
  std::int64_t next_index_ = 0;            ///< the first scan that isn't due yet
  std::optional<scip::ScanRequest> stream_;
  int left_ = 0;     ///< scans of a stream with an end
  int skipped_ = 0;  ///< since the last one sent

  bool in_scip1_ = false;
  bool laser_on_ = false;
  bool in_time_mode_ = false;
  bool was_rebooted_ = false;
  int baud_ = 19200;

  std::int64_t clock_host_ns_;    ///< the device's clock was set or changed its pace then ...
  double clock_device_ns_ = 0.0;  ///< ... and showed this
  double drift_ppm_ = 0.0;
};

}  // namespace odoless
