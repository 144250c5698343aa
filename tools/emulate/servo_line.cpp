#include "tools/emulate/servo_line.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <string_view>
#include <utility>

#include "drivers/io/socket_can.hpp"
#include "rt/clock.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr int kFramesPerRound = 256;

class ServoStream final : public ServoLine {
 public:
  explicit ServoStream(std::unique_ptr<EmulatedLine> line) : line_(std::move(line)) {}

  [[nodiscard]] int descriptor() override { return line_->has_client() ? line_->descriptor() : -1; }
  [[nodiscard]] bool has_waiting() const override { return !waiting_.empty(); }
  [[nodiscard]] int baud() override { return line_->baud(); }

  [[nodiscard]] std::vector<ServoFrame> read() override {
    flush();
    const std::string bytes = line_->has_client() ? line_->read() : std::string();
    const auto view = std::as_bytes(std::span(bytes.data(), bytes.size()));
    return bytes.empty() ? std::vector<ServoFrame>{} : std::vector<ServoFrame>{{view.begin(), view.end()}};
  }

  void write(const ServoFrame& frame) override {
    if (waiting_.size() < kWaitingMax) {
      waiting_.append(reinterpret_cast<const char*>(frame.data()), frame.size());
    }
    flush();
  }

 private:
  static constexpr std::size_t kWaitingMax = 65'536;

  void flush() { waiting_.erase(0, line_->has_client() ? line_->write(waiting_) : waiting_.size()); }

  std::unique_ptr<EmulatedLine> line_;
  std::string waiting_;  ///< for a client that is slow to read
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
      const Errc error = read_can(socket_.get(), clock_, received);
      if (error == Errc::kNotYet || error == Errc::kLinkDown) {
        break;
      }
      if (error != Errc::kOk) {
        socket_.reset();
        break;
      }
      if (log_) {
        log_->write({wall_us() - (clock_.now_ns() - received.stamp_ns) / 1000, interface_, received.frame});
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

  MonotonicClock clock_;
  std::string interface_;
  std::optional<CandumpWriter> log_;
  FileDescriptor socket_;
  Errc error_ = Errc::kOk;
};

}  // namespace

std::unique_ptr<ServoLine> make_servo_stream(std::unique_ptr<EmulatedLine> line) {
  return std::make_unique<ServoStream>(std::move(line));
}

std::unique_ptr<ServoLine> make_servo_can(const std::string& interface, const std::filesystem::path& log) {
  return std::make_unique<ServoCan>(interface, log);
}

pollfd waits_for(ServoLine& line) {
  return {
      .fd = line.descriptor(), .events = static_cast<short>(POLLIN | (line.has_waiting() ? POLLOUT : 0)), .revents = 0};
}

void LoopedServo::step(std::int64_t now_ns) {
  servo_.set_line_baud(line_.baud());
  for (const ServoFrame& frame : line_.read()) {
    servo_.receive(frame, now_ns);
  }
  servo_.tick(now_ns);
  for (const ServoFrame& frame : servo_.take_output()) {
    line_.write(frame);
  }
}

}  // namespace odoless
