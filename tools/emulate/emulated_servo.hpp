#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tools/emulate/faults.hpp"

namespace odoless {

/// What an emulated servo sends at once: a CAN frame, or a packet on a serial line.
using ServoFrame = std::vector<std::byte>;

/// A servo that isn't there: frames and the host's time in, frames out. Its faults count from the first frame that it
/// receives.
class EmulatedServo {
 public:
  EmulatedServo() = default;
  EmulatedServo(const EmulatedServo&) = delete;
  EmulatedServo& operator=(const EmulatedServo&) = delete;
  virtual ~EmulatedServo() = default;

  /// On CAN exactly one frame (CanFrame), else any piece of the stream.
  virtual void receive(std::span<const std::byte> bytes, std::int64_t now_ns) = 0;
  /// Lets time pass until `now_ns`.
  virtual void tick(std::int64_t now_ns) = 0;
  /// When there is something to do by itself; while it moves, often.
  [[nodiscard]] virtual std::int64_t next_event_ns() const = 0;
  /// What is to be sent, in order.
  [[nodiscard]] virtual std::vector<ServoFrame> take_output() = 0;

  /// The rate that the client has set the line to; 0: a line that has none.
  virtual void set_line_baud(int /*baud*/) {}

  /// Where the axis truly is, by the servo's own zero.
  [[nodiscard]] virtual double angle_rad() const = 0;
  [[nodiscard]] virtual double velocity_radps() const = 0;
};

/// The time of an emulated servo: the host's, as its faults bend it, and when it says and hears nothing.
class ServoTime {
 public:
  ServoTime(std::vector<Fault> faults, std::int64_t now_ns) : faults_(std::move(faults)), last_ns_(now_ns) {}

  /// Somebody speaks to the servo.
  void start(std::int64_t now_ns) { start_ns_ = start_ns_ < 0 ? now_ns : start_ns_; }
  /// The fault of that kind that is active, or null.
  [[nodiscard]] const Fault* fault(FaultKind kind, std::int64_t now_ns) const {
    return start_ns_ < 0 ? nullptr : active_fault(faults_, kind, now_ns - start_ns_);
  }
  /// How much of its own time has passed since the last call.
  [[nodiscard]] double elapsed_s(std::int64_t now_ns) {
    const Fault* const drift = fault(FaultKind::kDrift, now_ns);
    const double host_s = static_cast<double>(now_ns - last_ns_) * 1e-9;
    last_ns_ = now_ns;
    return host_s * (1.0 + (drift == nullptr ? 0.0 : drift->value * 1e-6));
  }

  /// The servo starts: until then nobody hears of it.
  void start_until(std::int64_t ready_ns) { ready_ns_ = ready_ns; }
  [[nodiscard]] bool is_starting(std::int64_t now_ns) const { return now_ns < ready_ns_; }
  [[nodiscard]] bool is_silent(std::int64_t now_ns) const {
    return is_starting(now_ns) || fault(FaultKind::kSilence, now_ns) != nullptr;
  }
  /// A fault that makes it start anew, once, or null.
  [[nodiscard]] const Fault* reboot(std::int64_t now_ns) {
    const Fault* const reboot = fault(FaultKind::kReboot, now_ns);
    return std::exchange(was_rebooted_, reboot != nullptr) ? nullptr : reboot;
  }

 private:
  std::vector<Fault> faults_;
  std::int64_t start_ns_ = -1;
  std::int64_t last_ns_;
  std::int64_t ready_ns_ = 0;
  bool was_rebooted_ = false;
};

/// What an emulated servo on a serial line answers, each at its time.
class ServoAnswers {
 public:
  /// Behind those that wait.
  void add(ServoFrame frame, std::int64_t due_ns) {
    waiting_.push_back({waiting_.empty() ? due_ns : std::max(due_ns, waiting_.back().due_ns), std::move(frame)});
  }
  void clear() { waiting_.clear(); }
  /// The one that was added last, which is sent at once instead.
  [[nodiscard]] ServoFrame take_last() {
    ServoFrame frame = std::move(waiting_.back().frame);
    waiting_.pop_back();
    return frame;
  }
  /// Puts what is due behind `output`, or drops it where the servo is silent.
  void send_due(std::int64_t now_ns, bool is_silent, std::vector<ServoFrame>& output) {
    for (; !waiting_.empty() && waiting_.front().due_ns <= now_ns; waiting_.pop_front()) {
      if (!is_silent) {
        output.push_back(std::move(waiting_.front().frame));
      }
    }
  }
  /// When the next is due, and `at_the_latest_ns`.
  [[nodiscard]] std::int64_t next_ns(std::int64_t at_the_latest_ns) const {
    return waiting_.empty() ? at_the_latest_ns : std::min(at_the_latest_ns, waiting_.front().due_ns);
  }

 private:
  struct Answer {
    std::int64_t due_ns = 0;
    ServoFrame frame;
  };
  std::deque<Answer> waiting_;
};

}  // namespace odoless
