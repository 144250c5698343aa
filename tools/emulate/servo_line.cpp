#include "tools/emulate/servo_line.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <utility>

#include "drivers/io/socket_can.hpp"
#include "rt/cpu_clock.hpp"
#include "tools/command/error.hpp"
#include "tools/emulate/stop_signals.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kIdleNs = 20'000'000;
constexpr int kFramesPerRound = 256;

class ServoTerminal final : public ServoLine {
 public:
  explicit ServoTerminal(const std::filesystem::path& link) : terminal_(link) {}

  [[nodiscard]] int descriptor() override { return terminal_.has_client() ? terminal_.descriptor() : -1; }

  [[nodiscard]] std::vector<ServoFrame> read() override {
    const std::string bytes = terminal_.has_client() ? terminal_.read() : std::string();
    const auto view = std::as_bytes(std::span(bytes.data(), bytes.size()));
    return bytes.empty() ? std::vector<ServoFrame>{} : std::vector<ServoFrame>{{view.begin(), view.end()}};
  }

  void write(const ServoFrame& frame) override {
    if (terminal_.has_client()) {
      static_cast<void>(terminal_.write({reinterpret_cast<const char*>(frame.data()), frame.size()}));
    }
  }

 private:
  PseudoTerminal terminal_;
};

class ServoCan final : public ServoLine {
 public:
  ServoCan(std::string interface, const std::filesystem::path& log) : interface_(std::move(interface)) {
    if (!log.empty()) {
      log_.emplace(log);
    }
    open();
    if (!socket_.valid()) {
      throw NoInputError(fmt::format("--can {}: {}", interface_, describe(error_)));
    }
  }

  [[nodiscard]] int descriptor() override { return socket_.get(); }

  [[nodiscard]] std::vector<ServoFrame> read() override {
    std::vector<ServoFrame> frames;
    if (!socket_.valid()) {
      open();
    }
    CanReceived received;
    for (int i = 0; i < kFramesPerRound && socket_.valid(); ++i) {
      const Errc error = read_can(socket_.get(), monotonic_ns(), received);
      if (error == Errc::kNotYet || error == Errc::kLinkDown) {
        break;
      }
      if (error != Errc::kOk) {
        socket_.reset();
        break;
      }
      if (log_) {
        log_->write({wall_us() - (monotonic_ns() - received.stamp_ns) / 1000, interface_, received.frame});
      }
      frames.emplace_back(as_bytes(received.frame).begin(), as_bytes(received.frame).end());
    }
    return frames;
  }

  void write(const ServoFrame& frame) override { static_cast<void>(write_can(socket_.get(), *to_can_frame(frame))); }

 private:
  static std::int64_t wall_us() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
  }

  void open() {
    constexpr std::array<CanFilter, 1> kAll{{{.id = 0, .mask = 0}}};
    Result<FileDescriptor> opened = open_can(interface_, kAll);
    error_ = opened.error();
    if (opened.ok()) {
      socket_ = opened.take();
    }
  }

  std::string interface_;
  std::optional<CandumpWriter> log_;
  FileDescriptor socket_;
  Errc error_ = Errc::kOk;
};

}  // namespace

std::unique_ptr<ServoLine> make_servo_terminal(const std::filesystem::path& link) {
  return std::make_unique<ServoTerminal>(link);
}

std::unique_ptr<ServoLine> make_servo_can(const std::string& interface, const std::filesystem::path& log) {
  return std::make_unique<ServoCan>(interface, log);
}

void emulate_servo(EmulatedServo& servo, ServoLine& line, std::int64_t duration_ns) {
  const StopSignals signals;
  const std::int64_t end_ns = monotonic_ns() + std::min(duration_ns, std::int64_t{1} << 62U);
  while (!StopSignals::stopped() && monotonic_ns() < end_ns) {
    for (const ServoFrame& frame : line.read()) {
      servo.receive(frame, monotonic_ns());
    }
    servo.tick(monotonic_ns());
    for (const ServoFrame& frame : servo.take_output()) {
      line.write(frame);
    }
    const int descriptor = line.descriptor();
    const std::int64_t until_ns = std::min(end_ns, servo.next_event_ns());
    const std::int64_t wait_ns = descriptor < 0 ? kIdleNs : until_ns - monotonic_ns();
    const timespec timeout{.tv_sec = 0, .tv_nsec = std::clamp<std::int64_t>(wait_ns, 0, kIdleNs)};
    pollfd poll{.fd = descriptor, .events = POLLIN, .revents = 0};
    static_cast<void>(::ppoll(&poll, 1, &timeout, &signals.mask()));
  }
}

}  // namespace odoless
