#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/sync_clock.hpp"
#include "firmware/gpio/gpio_signals.hpp"
#include "firmware/sources/line_handover.hpp"
#include "firmware/stages/scan_source.hpp"

namespace odoless {

/// A laser range finder on its line: serial, TCP or USB.
///
/// A line on which the session has lost the laser is given back, to be opened anew, when no scan has come for 2 s, but
/// only where the session has just waited long enough: what a slow laser is at is never cut off. Of an outage, which
/// ends with the next scan, each thing is told once.
///
/// Thread: sensor thread. Real time: system calls read, write, and ioctl where the rate of the line changes.
class LrfSource final : public ScanSource, private LrfSink {
 public:
  LrfSource(const LrfParams& params, int beams_max, LineHandover& line);

  /// To be called before the thread starts, if at all: tells when scans come, and takes sync pulses.
  /// @param sync_delay_ns  From a pulse to the first beam; nothing: there are none.
  void attach(GpioSignals& signals, std::optional<std::int64_t> sync_delay_ns);

  [[nodiscard]] int descriptor() const override { return is_left_alone() ? -1 : descriptor_; }
  [[nodiscard]] std::int64_t next_deadline_ns() const override;
  void work(const Clock& clock, ScanSink& sink) override;
  [[nodiscard]] bool is_open() const override { return descriptor_ >= 0; }
  void add_counts(SourceHealth& health) const override;

 private:
  void on_scan(const LrfScan& scan) override;
  void on_event(const LrfEvent& event) override;
  void take_line(std::int64_t now_ns);
  void return_line();
  /// False when the line has ended; errno then says how, 0 as by the other side.
  [[nodiscard]] bool read_all(const Clock& clock);
  void count_empty_round(bool is_empty, std::int64_t now_ns);
  /// A line that says that it has bytes and gives none, for the time until it is asked again.
  [[nodiscard]] bool is_left_alone() const { return is_open() && empty_rounds_ >= kEmptyRounds; }
  void set_rate();
  void write_all();
  /// Tells of an outage; each `kind` once.
  void tell_once(Errc kind, EventPriority priority, EventText text, std::int64_t number = 0);
  [[nodiscard]] std::int64_t synchronized_ns(std::int64_t stamp_ns);

  static constexpr int kReadsPerRound = 16;
  static constexpr int kEmptyRounds = 20;  ///< in a row: none that waits for time is so
  static constexpr std::int64_t kLeftAlone_ns = 1'000'000;
  static constexpr std::int64_t kSyncMissing = 20;           ///< scans without a pulse that are told of
  static constexpr std::int64_t kReopen_ns = 2'000'000'000;  ///< without a scan: perhaps opening anew helps
  static constexpr std::size_t kKinds = 64;                  ///< more than Errc has

  LrfParams params_;
  bool is_tcp_;
  std::unique_ptr<LrfSession> session_;
  LineHandover& line_;
  int descriptor_ = -1;
  int baud_ = 0;
  int empty_rounds_ = 0;  ///< that came at once after each other and read nothing
  std::int64_t last_round_ns_ = 0;
  std::int64_t last_scan_or_open_ns_ = 0;
  bool is_lost_ = false;      ///< the session has said so since the line was opened or a scan came
  bool has_rate_ = false;     ///< of the line
  std::bitset<kKinds> told_;  ///< since the last scan, by kind
  std::optional<int> told_device_status_;
  std::int64_t opened_ = 0;
  std::int64_t refused_ = 0;  ///< times that the laser was refused while it was brought up
  GpioSignals* signals_ = nullptr;
  std::optional<SyncClock> sync_;
  ScanSink* sink_ = nullptr;  ///< during `work`
  std::array<std::byte, 4096> buffer_{};
};

}  // namespace odoless
