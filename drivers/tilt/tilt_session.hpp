#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/tilt/tilt_params.hpp"

namespace odoless {

/// One measured angle of the tilt axis.
struct TiltSample {
  std::int64_t stamp_ns = 0;    ///< when it was measured, on the host's monotonic clock; later than the one before
  std::int64_t arrival_ns = 0;  ///< when the frame came that told it
  double angle_rad = 0.0;       ///< from the level pose, positive is down
  double velocity_radps = 0.0;
};

enum class TiltState : std::uint8_t {
  kBringUp,   ///< not usable yet, or not any more: looked for, set up, or switched on
  kHoming,    ///< finds its zero
  kMoving,    ///< on its way to the level pose
  kLevel,     ///< holds the level pose
  kSweeping,  ///< nods
  kStopped,   ///< stands where it was told to stop
  kFault,     ///< stalled or reports a fault: stopped, and tried again after a pause
};

enum class TiltEventType : std::uint8_t {
  kReady,        ///< set up, switched on, obeys from now on
  kRejected,     ///< a frame was refused; `reason` says why
  kDeviceError,  ///< the servo refuses something or reports a fault; `error` says how, `code` what
  kStalled,      ///< it doesn't move as it should, and was stopped
  kLost,         ///< it doesn't answer, has started anew or was taken away; the session brings it up again
  kBusError,     ///< the bus reports an error; `code` is its class
  kDoesWithout,  ///< it refuses something without which it does as well; `code` is a TiltLack
};
inline constexpr std::size_t kTiltEventTypes = 7;

/// What a servo cannot do by itself, and is used without.
enum class TiltLack : std::uint8_t {
  kWatchOfDaemon,      ///< notice that the daemon is dead
  kStopWithoutDaemon,  ///< be told what to do then
  kHoldAfterStop,      ///< keep its torque once it is stopped
  kLimits,             ///< keep its limits
  kHeartbeat,          ///< tell that it lives
  kMeasurement,        ///< measure its angle: it tells what it was told
};
inline constexpr std::size_t kTiltLacks = 6;

/// How a servo told an error, which says what its `code` means.
enum class TiltError : std::uint8_t {
  kNone,
  kAbort,        ///< CANopen: it refuses `object`; an abort code (CiA 301)
  kEmergency,    ///< CANopen: an emergency message's error code
  kFault,        ///< CANopen: a fault's error code (603Fh); -1: it doesn't say
  kStatusWord,   ///< CANopen: its status word (6041h), with which it doesn't switch on or find its zero
  kDeviceType,   ///< CANopen: a device type (1000h) that is no drive's
  kErrorNumber,  ///< Dynamixel: it refuses what was asked of `object`; the error of its answer
  kHardware,     ///< Dynamixel: bits of its hardware error status
  kModel,        ///< Dynamixel: the number of a model whose control table is another
  kErrorFlags,   ///< Maestro: bits of its errors
};
inline constexpr std::size_t kTiltErrors = 10;

struct TiltEvent {
  TiltEventType type = TiltEventType::kReady;
  Errc reason = Errc::kOk;
  TiltError error = TiltError::kNone;
  std::int64_t code = -1;    ///< of the device's protocol; -1: none
  std::uint32_t object = 0;  ///< CANopen: index and sub-index, as 607A00h; Dynamixel: address in its control table

  bool operator==(const TiltEvent&) const = default;
};

/// Takes what a session has found. Real time: called on the session's thread, from within its calls.
class TiltSink {
 public:
  TiltSink() = default;
  virtual void on_angle(const TiltSample& sample) = 0;
  virtual void on_event(const TiltEvent& event) = 0;

 protected:
  TiltSink(const TiltSink&) = default;
  TiltSink& operator=(const TiltSink&) = default;
  TiltSink(TiltSink&&) = default;
  TiltSink& operator=(TiltSink&&) = default;
  ~TiltSink() = default;
};

/// How often what happened since construction.
struct TiltCounters {
  std::uint64_t frames = 0;         ///< whole ones, of whatever content
  std::uint64_t samples = 0;        ///< given to the sink
  std::uint64_t rejected = 0;       ///< frames refused, for whatever reason
  std::uint64_t wrong_sums = 0;     ///< of these: a check sum didn't match
  std::uint64_t implausible = 0;    ///< of these: the angle cannot be
  std::uint64_t wrong_echoes = 0;   ///< of these: what came back is not what was sent, or not what was asked for
  std::uint64_t echoes = 0;         ///< own frames that came back unchanged, as half-duplex adapters send them
  std::uint64_t timeouts = 0;       ///< requests without an answer in time
  std::uint64_t device_errors = 0;  ///< refusals and faults that the servo told
  std::uint64_t bus_errors = 0;
  std::uint64_t stalls = 0;
  std::uint64_t restarts = 0;  ///< bring-ups after the first

  /// Counts what was refused, and tells of it.
  void reject(Errc reason, TiltSink& sink);
  /// Counts an error of the device's own, and tells of it.
  void tell_device_error(TiltError error, std::int64_t code, TiltSink& sink, std::uint32_t object = 0);
};

/// The protocol of one servo, from any state that it may be in to obeying, and back to that after every fault. It does
/// no input or output and knows no clock: frames and stamps come in, frames go out.
///
///   session.reset(now);                                  // after the line was opened, and when it was opened again
///   loop: while (!(frame = transmit()).empty()) write(frame) ; ppoll(line, next_deadline_ns()) ;
///         receive(bytes) for all that came, tick(now)
///
/// On a byte stream `receive` takes any piece of it; on CAN exactly one frame, as the bytes of a CanFrame. The command
/// holds through every bring-up, and until another one; a servo that is lost is taken for stopped, as it stops itself
/// when it hears nothing any more.
///
/// Thread: one thread. Real time: after construction no call allocates, waits or makes a system call; time is linear in
/// the bytes given.
class TiltSession {
 public:
  TiltSession() = default;
  TiltSession(const TiltSession&) = delete;
  TiltSession& operator=(const TiltSession&) = delete;
  TiltSession(TiltSession&&) = delete;
  TiltSession& operator=(TiltSession&&) = delete;
  virtual ~TiltSession() = default;

  /// The line was opened: forgets what was half received and starts the bring-up.
  virtual void reset(std::int64_t now_ns) = 0;

  /// What to do from now on. A stop goes before all else that waits. The same command once more does nothing.
  virtual void command(TiltCommand command, std::int64_t now_ns) = 0;

  /// The last: how the servo is to be left. It is no more watched for the daemon's signs of life from then on, so that
  /// it stays so. Where it was being brought up, it is left as it is, but for its torque.
  virtual void finish(TiltEnd end, std::int64_t now_ns) = 0;
  /// Whether it has confirmed that, or is lost: nothing is sent any more, until a reset. Its owner is to be patient
  /// for some 0.2 s.
  [[nodiscard]] virtual bool is_finished() const = 0;

  /// Decodes; calls `sink` for every angle and event found, in order.
  virtual void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, TiltSink& sink) = 0;

  /// One frame to be written now; empty: no more. To be called until it is empty, after each call of the others. The
  /// session takes it for written: what the line doesn't take at once, its owner drops. Valid until the next call.
  [[nodiscard]] virtual std::span<const std::byte> transmit() = 0;

  /// Does what is due at `now_ns`; before `next_deadline_ns` it does nothing.
  virtual void tick(std::int64_t now_ns, TiltSink& sink) = 0;
  [[nodiscard]] virtual std::int64_t next_deadline_ns() const = 0;

  [[nodiscard]] virtual TiltState state() const = 0;
  [[nodiscard]] virtual const TiltCounters& counters() const = 0;
};

}  // namespace odoless
