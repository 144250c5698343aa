#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

#include "drivers/tilt/tilt_history.hpp"
#include "drivers/tilt/tilt_line.hpp"
#include "firmware/gpio/gpio_signals.hpp"
#include "firmware/pipeline/messages.hpp"
#include "firmware/sources/line_handover.hpp"
#include "firmware/stages/scan_source.hpp"

namespace odoless {

/// The servo that tilts the laser, on its line.
///
/// Thread: sensor thread; those marked so from any. Real time: system calls read or recvmsg, and write.
// NOLINTNEXTLINE(cppcoreguidelines-virtual-class-destructor): final, and owned as what it is
class TiltSource final : private TiltSink {
 public:
  TiltSource(const TiltParams& params, LineHandover& line);

  /// To be called before the thread starts, if at all: while these say so, the servo is stopped.
  void obey_stop(const GpioSignals& gpio) { gpio_ = &gpio; }

  [[nodiscard]] int descriptor() const { return is_link_down_ ? -1 : descriptor_; }
  [[nodiscard]] std::int64_t next_deadline_ns() const;
  void work(const Clock& clock, ScanSink& sink);
  [[nodiscard]] TiltReport report() const;
  /// Whether the laser was level from that time, a scan's first beam, until now. Where the servo has never told, the
  /// laser is taken to be as level as without one; where it is lost, to be where it was seen last. While the servo
  /// finds its zero it moves and tells no angle: not level, until it tells one again.
  [[nodiscard]] bool was_level_since(std::int64_t stamp_ns) const;
  /// Angles for the beams' times.
  [[nodiscard]] const TiltHistory& history() const { return history_; }

  /// The last but for `work`, which is to be called until it has ended, or for 0.25 s: how the servo is to be left
  /// (tilt.at_end); where it is while the stop line says so.
  void end(std::int64_t now_ns);
  [[nodiscard]] bool has_ended() const { return !is_open() || session_->is_finished(); }

  /// Any thread: what to do from now on; the sensor thread is to be woken.
  void request(TiltCommand command) { wanted_.store(command, std::memory_order_release); }

 private:
  void on_angle(const TiltSample& sample) override;
  void on_event(const TiltEvent& event) override;
  void take_line(std::int64_t now_ns);
  void return_line();
  void obey(std::int64_t now_ns);
  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  [[nodiscard]] bool is_level(double angle_rad) const;
  /// False when the line has ended.
  [[nodiscard]] bool read_all(const Clock& clock);
  [[nodiscard]] bool write_all();
  /// Of what a read or a write came to: says when the link has gone down or come up.
  void tell_link(Errc error);
  /// Whether the log is to be told: not of what it was told just before.
  [[nodiscard]] bool is_news(const TiltEvent& event);
  /// For the recorder: a frame of CAN as a line of candump.
  void tell_raw(std::span<const std::byte> bytes, std::int64_t stamp_ns, bool to_device);

  static constexpr int kReadsPerRound = 64;
  static constexpr std::int64_t kLinkPause_ns = 20'000'000;           ///< between looks at a link that is down
  static constexpr std::int64_t kEventPause_ns = 1'000'000'000;       ///< between log lines of one kind ...
  static constexpr std::int64_t kSameEventPause_ns = 60'000'000'000;  ///< ... that say the same, until it obeys again

  TiltParams params_;
  std::unique_ptr<TiltSession> session_;
  LineHandover& line_;
  TiltHistory history_;
  std::atomic<TiltCommand> wanted_;
  const GpioSignals* gpio_ = nullptr;
  int descriptor_ = -1;
  bool ends_ = false;
  bool is_link_down_ = false;
  bool link_told_down_ = false;
  std::int64_t now_ns_ = 0;
  struct Told {
    TiltEvent event;
    std::int64_t at_ns = 0;  ///< 0: never
  };
  std::array<Told, kTiltEventTypes + kTiltErrors + kTiltLacks> told_{};  ///< since it obeyed, one of each kind
  double last_angle_rad_ = 0.0;
  bool has_angle_ = false;
  bool had_angle_ = false;
  std::int64_t seen_since_ns_ = std::numeric_limits<std::int64_t>::min();  ///< before, it moved unseen: in homing
  ScanSink* sink_ = nullptr;                                               ///< during `work`
  std::array<std::byte, 1024> buffer_{};
};

}  // namespace odoless
