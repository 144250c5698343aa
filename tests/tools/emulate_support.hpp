#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/io/serial_port.hpp"
#include "drivers/lrf/make_lrf_session.hpp"
#include "tests/support/times.hpp"
#include "tools/emulate/lrf_models.hpp"
#include "tools/emulate/scip_device.hpp"
#include "tools/emulate/world_source.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless::test {

/// What a session told, copied.
struct HeardScan {
  std::int64_t stamp_ns = 0;
  std::int64_t arrival_ns = 0;
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
  std::vector<float> ranges_m;
  std::int64_t beam_period_ns = 0;
};

class Heard final : public LrfSink {
 public:
  void on_scan(const LrfScan& scan) override {
    scans.push_back({scan.stamp_ns,
                     scan.arrival_ns,
                     scan.start_angle_rad,
                     scan.angle_step_rad,
                     {scan.ranges_m.begin(), scan.ranges_m.end()},
                     scan.beam_period_ns});
  }
  void on_event(const LrfEvent& event) override { events.push_back(event); }

  [[nodiscard]] int count(LrfEventType type) const {
    int found = 0;
    for (const LrfEvent& event : events) {
      found += event.type == type ? 1 : 0;
    }
    return found;
  }

  std::vector<HeardScan> scans;
  std::vector<LrfEvent> events;
};

inline WorldDrive small_drive() {
  WorldDrive drive;
  drive.world = parse_world("room 0 0  8 4\nbox 6 3  1 0.6\nspeed 1\ngo 1 2  6 2\n", "small");
  return drive;
}

inline std::int64_t period_ns_of(const std::string& model) {
  for (const EmulatedLrfModel& known : emulated_lrf_models()) {
    if (known.name == model) {
      return known.period_ns;
    }
  }
  return 0;
}

/// A session and an emulated device on a line without delay, in made-up time.
class Bench {
 public:
  explicit Bench(const std::string& model = "utm-30lx", EmulatedLrfOptions options = {}, LrfParams params = {},
                 WorldDrive drive = small_drive())
      : Bench(model, std::make_unique<WorldSource>(period_ns_of(model), std::move(drive)), std::move(options), params) {
  }

  Bench(const std::string& model, std::unique_ptr<EmulatedScans> source, EmulatedLrfOptions options, LrfParams params)
      : name_(model),
        source_(std::move(source)),
        has_rate_(!params.device.starts_with("tcp://")),
        device_(make_emulated_lrf(model, *source_, std::move(options), now_ns_)),
        session_(make_lrf_session(params, 2048)) {}

  /// Lets that time pass, a quarter of a millisecond at a time.
  void run(std::int64_t duration_ns) {
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += kMs / 4) {
      step();
    }
  }

  void reset() { session_->reset(now_ns_); }
  /// What a client that was there before has said.
  void say(const std::string& bytes) {
    device_->set_line_baud(0);
    device_->receive(bytes, now_ns_);
  }

  [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }
  [[nodiscard]] const Heard& heard() const { return heard_; }
  [[nodiscard]] LrfSession& session() { return *session_; }
  [[nodiscard]] const ScipModel& model() const { return *find_scip_model(name_); }
  [[nodiscard]] EmulatedLrf& device() { return *device_; }
  [[nodiscard]] EmulatedScans& source() { return *source_; }
  [[nodiscard]] const std::vector<SentScan>& sent() const { return sent_; }
  [[nodiscard]] const std::string& written() const { return written_; }

  /// Changes what is on its way to the session.
  std::function<void(std::string&)> on_the_way = [](std::string&) {};
  bool host_asleep = false;
  std::int64_t line_delay_ns = 0;  ///< of each way

 private:
  struct OnTheWay {
    std::int64_t due_ns = 0;
    std::string bytes;
  };
  /// Puts bytes onto one way of the line, and takes off what has come through.
  [[nodiscard]] std::string carried(std::deque<OnTheWay>& way, std::string bytes) const {
    if (!bytes.empty()) {
      way.push_back({now_ns_ + line_delay_ns, std::move(bytes)});
    }
    std::string arrived;
    for (; !way.empty() && way.front().due_ns <= now_ns_; way.pop_front()) {
      arrived += way.front().bytes;
    }
    return arrived;
  }

  void step() {
    const auto request = session_->transmit();
    written_.append(reinterpret_cast<const char*>(request.data()), request.size());
    device_->set_line_baud(has_rate_ ? session_->line_baud() : 0);
    device_->receive(carried(to_device_, {reinterpret_cast<const char*>(request.data()), request.size()}), now_ns_);
    device_->tick(now_ns_);
    std::string sent;
    for (SentBytes& bytes : device_->take_output()) {
      if (bytes.scan) {
        sent_.push_back(*bytes.scan);
      }
      on_the_way(bytes.bytes);
      sent += bytes.bytes;
    }
    waiting_ += carried(to_session_, std::move(sent));
    if (!host_asleep) {
      const std::string bytes = std::exchange(waiting_, {});
      session_->receive(std::as_bytes(std::span(bytes.data(), bytes.size())), now_ns_, heard_);
      session_->tick(now_ns_, heard_);
    }
  }

  std::int64_t now_ns_ = 1000 * kSecond;
  std::string name_;
  std::unique_ptr<EmulatedScans> source_;
  bool has_rate_;  ///< nobody can set that of a socket
  std::unique_ptr<EmulatedLrf> device_;
  std::unique_ptr<LrfSession> session_;
  Heard heard_;
  std::vector<SentScan> sent_;
  std::string written_;
  std::string waiting_;
  std::deque<OnTheWay> to_device_;
  std::deque<OnTheWay> to_session_;
};

}  // namespace odoless::test
