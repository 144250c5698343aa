#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "drivers/tilt/tilt_line.hpp"
#include "tools/emulate/cia402_device.hpp"
#include "tools/emulate/dynamixel_device.hpp"
#include "tools/emulate/faults.hpp"
#include "tools/emulate/maestro_device.hpp"

namespace odoless::test {

constexpr std::int64_t kServoMs = 1'000'000;
constexpr std::int64_t kServoSecond = 1'000'000'000;

/// What a session told, copied.
class HeardTilt final : public TiltSink {
 public:
  void on_angle(const TiltSample& sample) override { samples.push_back(sample); }
  void on_event(const TiltEvent& event) override { events.push_back(event); }

  [[nodiscard]] int count(TiltEventType type) const {
    int found = 0;
    for (const TiltEvent& event : events) {
      found += event.type == type ? 1 : 0;
    }
    return found;
  }
  [[nodiscard]] bool has(TiltEventType type, Errc reason) const {
    for (const TiltEvent& event : events) {
      if (event.type == type && event.reason == reason) {
        return true;
      }
    }
    return false;
  }

  std::vector<TiltSample> samples;
  std::vector<TiltEvent> events;
};

/// Where the axis truly was, and when.
struct TrueAngle {
  std::int64_t stamp_ns = 0;
  double angle_rad = 0.0;
};

inline TiltParams servo_params(TiltDriver driver) {
  TiltParams params;
  params.driver = driver;
  return params;
}

inline std::vector<Fault> faults_of(const std::string& text) { return {parse_fault(text)}; }

/// A CAN frame with these data.
inline CanFrame data_frame(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  CanFrame made;
  made.id = id;
  made.size_bytes = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), made.data.begin());
  return made;
}

/// Of the contract's: a servo that measures where it is.
struct TestedServo {
  const char* name = "";
  TiltDriver driver = TiltDriver::kNone;
  bool is_cyclic = false;
};
inline constexpr TestedServo kTestedServos[] = {{"cia402", TiltDriver::kCia402},
                                                {"cia402_cyclic", TiltDriver::kCia402, true},
                                                {"dynamixel", TiltDriver::kDynamixel}};
inline void PrintTo(const TestedServo& servo, std::ostream* out) { *out << servo.name; }

inline TiltParams servo_params(const TestedServo& servo) {
  TiltParams params = servo_params(servo.driver);
  params.cyclic_position = servo.is_cyclic;
  return params;
}

/// An emulated servo's axis.
struct ServoAxis {
  double start_rad = 0.2;
  double droop_radps = 0.0;  ///< without torque
};

/// A session and an emulated servo on a line without delay, in made-up time.
class ServoBench {
 public:
  explicit ServoBench(TiltParams params, std::vector<Fault> faults = {})
      : ServoBench(params, make_servo(params, std::move(faults))) {}
  ServoBench(const TiltParams& params, std::unique_ptr<EmulatedServo> servo)
      : params_(params), servo_(std::move(servo)), session_(make_tilt_session(params)) {}

  static std::unique_ptr<EmulatedServo> make_servo(const TiltParams& params, std::vector<Fault> faults,
                                                   const ServoAxis& axis = {}) {
    if (params.driver == TiltDriver::kCia402) {
      Cia402DeviceOptions options;
      options.node = params.id;
      options.counts_per_turn = params.counts_per_turn;
      options.start_rad = axis.start_rad;
      options.droop_radps = axis.droop_radps;
      options.faults = std::move(faults);
      return std::make_unique<Cia402Device>(options, kStartNs);
    }
    if (params.driver == TiltDriver::kMaestro) {
      MaestroDeviceOptions options;
      options.channel = params.channel;
      options.start_rad = axis.start_rad;
      options.droop_radps = axis.droop_radps;
      options.faults = std::move(faults);
      return std::make_unique<MaestroDevice>(options, kStartNs);
    }
    DynamixelDeviceOptions options;
    options.id = params.id;
    options.start_rad = axis.start_rad;
    options.droop_radps = axis.droop_radps;
    options.faults = std::move(faults);
    return std::make_unique<DynamixelDevice>(options, kStartNs);
  }

  void reset() { session_->reset(now_ns_); }
  /// As a daemon does that is started anew.
  void restart_session() { session_ = make_tilt_session(params_); }
  void command(TiltCommand command) { session_->command(command, now_ns_); }

  /// Lets that time pass, a quarter of a millisecond at a time.
  void run(std::int64_t duration_ns) {
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += kServoMs / 4) {
      step();
    }
  }
  /// Until it holds; the time that it took, or -1.
  std::int64_t run_until(const std::function<bool()>& holds, std::int64_t longest_ns) {
    const std::int64_t start_ns = now_ns_;
    while (!holds()) {
      if (now_ns_ - start_ns >= longest_ns) {
        return -1;
      }
      step();
      now_ns_ += kServoMs / 4;
    }
    return now_ns_ - start_ns;
  }
  std::int64_t run_until(TiltState state, std::int64_t longest_ns) {
    return run_until([&] { return session_->state() == state; }, longest_ns);
  }

  [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }
  [[nodiscard]] TiltSession& session() { return *session_; }
  [[nodiscard]] EmulatedServo& servo() { return *servo_; }
  template <class Device>
  [[nodiscard]] Device& servo_as() {
    return dynamic_cast<Device&>(*servo_);
  }
  [[nodiscard]] HeardTilt& heard() { return heard_; }
  [[nodiscard]] const std::vector<TrueAngle>& truth() const { return truth_; }
  /// The true angle from the level pose, as the session should tell it.
  [[nodiscard]] double angle_rad() const {
    return (params_.inverted ? -1.0 : 1.0) * (servo_->angle_rad() - params_.level_angle_rad);
  }
  [[nodiscard]] double true_angle_rad(std::int64_t stamp_ns) const {
    const auto after =
        std::find_if(truth_.begin(), truth_.end(), [&](const TrueAngle& angle) { return angle.stamp_ns >= stamp_ns; });
    return after == truth_.end() ? truth_.back().angle_rad : after->angle_rad;
  }

  /// Changes what is on its way; a frame may be dropped (emptied), and more may be put in.
  std::function<void(std::vector<ServoFrame>&)> to_session = [](std::vector<ServoFrame>&) {};
  std::function<void(std::vector<ServoFrame>&)> to_servo = [](std::vector<ServoFrame>&) {};
  bool host_asleep = false;

 private:
  static constexpr std::int64_t kStartNs = 1000 * kServoSecond;

  void step() {
    servo_->tick(now_ns_);
    truth_.push_back({now_ns_, angle_rad()});
    std::vector<ServoFrame> replies = servo_->take_output();
    to_session(replies);
    waiting_.insert(waiting_.end(), replies.begin(), replies.end());
    if (host_asleep) {
      return;
    }
    for (const ServoFrame& frame : std::exchange(waiting_, {})) {
      session_->receive(frame, now_ns_, heard_);
    }
    session_->tick(now_ns_, heard_);
    std::vector<ServoFrame> requests;
    for (auto bytes = session_->transmit(); !bytes.empty(); bytes = session_->transmit()) {
      requests.emplace_back(bytes.begin(), bytes.end());
    }
    to_servo(requests);
    for (const ServoFrame& frame : requests) {
      servo_->receive(frame, now_ns_);
    }
  }

  TiltParams params_;
  std::unique_ptr<EmulatedServo> servo_;
  std::unique_ptr<TiltSession> session_;
  std::int64_t now_ns_ = kStartNs;
  HeardTilt heard_;
  std::vector<TrueAngle> truth_;
  std::vector<ServoFrame> waiting_;
};

}  // namespace odoless::test
