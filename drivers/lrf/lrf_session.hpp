#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"

namespace odoless {

/// One scan that a laser range finder sent.
struct LrfScan {
  /// When the first beam was measured, on the host's monotonic clock; whole microseconds, later than the scan's before.
  std::int64_t stamp_ns = 0;
  std::int64_t arrival_ns = 0;      ///< when the bytes came that completed the scan, on the same clock
  double start_angle_rad = 0.0;     ///< of the first beam in the scan frame; of float precision, as in messages
  double angle_step_rad = 0.0;      ///< positive: counter-clockwise; beams stand in the order of their time
  std::int64_t beam_period_ns = 0;  ///< from beam to beam; 0: unknown, or not even
  /// Infinity: nothing within the laser's range; 0: the device cannot say. Valid until the session's next call.
  std::span<const float> ranges_m{};
};

enum class LrfEventType : std::uint8_t {
  kReady,        ///< the device streams; `geometry()` holds from now on
  kResync,       ///< bytes were skipped to find the next frame
  kRejected,     ///< a frame was refused; `reason` says why
  kDeviceError,  ///< the device says that something is wrong with it; `device_status` is what it said
  kLost,         ///< the stream ended or the device doesn't answer; the session starts it anew
  kUnanswered,   ///< the device is there, and leaves unanswered what it is asked before its stream, or is too late
};

struct LrfEvent {
  LrfEventType type = LrfEventType::kReady;
  Errc reason = Errc::kOk;
  int device_status = -1;  ///< of the device's protocol; -1: none
};

/// Takes what a session has found. Real time: called on the session's thread, from within its calls.
class LrfSink {
 public:
  LrfSink() = default;
  virtual void on_scan(const LrfScan& scan) = 0;
  virtual void on_event(const LrfEvent& event) = 0;

 protected:
  LrfSink(const LrfSink&) = default;
  LrfSink& operator=(const LrfSink&) = default;
  LrfSink(LrfSink&&) = default;
  LrfSink& operator=(LrfSink&&) = default;
  ~LrfSink() = default;
};

/// How often what happened since construction.
struct LrfCounters {
  std::uint64_t bytes = 0;
  std::uint64_t scans = 0;          ///< given to the sink
  std::uint64_t rejected = 0;       ///< frames refused, each with its reason in an event
  std::uint64_t resyncs = 0;        ///< times that bytes had to be skipped
  std::uint64_t device_errors = 0;  ///< error statuses
  std::uint64_t restarts = 0;       ///< bring-ups after the first
  std::uint64_t clock_resets = 0;   ///< times that the device's clock was seen to start anew
  std::uint64_t identical = 0;      ///< scans equal to the one before, range for range: a live laser shows noise
  std::uint64_t identical_run = 0;  ///< of these: how many the last ones in a row are

  /// Counts a frame that was refused, and tells of it.
  void reject(Errc reason, LrfSink& sink);
};

/// What the device says of itself.
struct LrfGeometry {
  int beams = 0;
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  std::int64_t period_ns = 0;  ///< from scan to scan as they are sent
};

/// The protocol of one laser range finder, from any state that the device may be in to a stream of scans, and back to
/// it after every fault. It does no input or output and knows no clock: bytes and stamps come in, bytes go out.
///
/// Its owner waits for the line or `next_deadline_ns`, whichever is first; gives what it read to `receive`, calls
/// `tick` when the deadline is over, and then writes what `transmit` has:
///
///   session.reset(now);                                  // after the line was opened, and when it was opened again
///   loop: write(transmit()) ; ppoll(line, next_deadline_ns()) ; receive(bytes) or tick(now)
///
/// Thread: one thread. Real time: after construction no call allocates, waits or makes a system call; time is linear in
/// the bytes given.
class LrfSession {
 public:
  LrfSession() = default;
  LrfSession(const LrfSession&) = delete;
  LrfSession& operator=(const LrfSession&) = delete;
  LrfSession(LrfSession&&) = delete;
  LrfSession& operator=(LrfSession&&) = delete;
  virtual ~LrfSession() = default;

  /// The line was opened: forgets what was half received and starts the bring-up.
  virtual void reset(std::int64_t now_ns) = 0;

  /// Decodes; calls `sink` for every scan and event found, in order.
  virtual void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) = 0;

  /// Bytes to be written now; empty: none. The session takes them for written: what the line doesn't take at once, its
  /// owner may drop (the session asks again) but not send later. Valid until the next call.
  [[nodiscard]] virtual std::span<const std::byte> transmit() = 0;

  /// Does what is due at `now_ns`; before `next_deadline_ns` it does nothing.
  virtual void tick(std::int64_t now_ns, LrfSink& sink) = 0;
  [[nodiscard]] virtual std::int64_t next_deadline_ns() const = 0;

  /// Rate that the line should have now; 0: whatever it has. To be asked after each call, and set before transmitting.
  [[nodiscard]] virtual int line_baud() const = 0;

  [[nodiscard]] virtual bool ready() const = 0;
  /// Valid while `ready`.
  [[nodiscard]] virtual const LrfGeometry& geometry() const = 0;
  [[nodiscard]] virtual const LrfCounters& counters() const = 0;
};

}  // namespace odoless
