#include "tools/probe/ask_lrf.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <functional>

#include "drivers/io/device_line.hpp"
#include "drivers/io/serial_port.hpp"
#include "drivers/lrf/make_lrf_session.hpp"
#include "drivers/lrf/sick/sick_session.hpp"
#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr int kBeamsMax = 8192;

// NOLINTNEXTLINE(cppcoreguidelines-virtual-class-destructor): final, and owned as what it is
class Ears final : public LrfSink {
 public:
  void on_scan(const LrfScan& /*scan*/) override { has_scanned = true; }
  void on_event(const LrfEvent& event) override { is_broken |= event.type == LrfEventType::kDeviceError; }

  bool has_scanned = false;
  bool is_broken = false;
};

/// A session on an open line.
class Talk {
 public:
  Talk(LrfSession& session, int line, int baud) : session_(session), line_(line), baud_(baud) {
    session_.reset(monotonic_ns());
  }

  /// Goes on until that is so. @return  False: it isn't after `patience_ns`, or the line has ended.
  bool until(const std::function<bool()>& is_so, std::int64_t patience_ns) {
    for (const std::int64_t end_ns = monotonic_ns() + patience_ns; !is_so();) {
      write();
      if (!read() || monotonic_ns() >= end_ns) {
        return is_so();
      }
    }
    return true;
  }

  [[nodiscard]] const Ears& ears() const { return ears_; }

 private:
  void write() {
    if (const int wanted = session_.line_baud(); wanted != 0 && wanted != baud_) {
      static_cast<void>(set_serial_baud(line_, wanted));  // refused: nobody answers at that rate
      baud_ = wanted;
    }
    if (const auto request = session_.transmit(); !request.empty()) {
      static_cast<void>(::write(line_, request.data(), request.size()) < 0);  // the session asks again
    }
  }

  /// False: the line has ended.
  bool read() {
    pollfd ready{.fd = line_, .events = POLLIN, .revents = 0};
    const std::int64_t wait_ms = (session_.next_deadline_ns() - monotonic_ns()) / 1'000'000;
    ::poll(&ready, 1, static_cast<int>(std::clamp<std::int64_t>(wait_ms, 1, 50)));
    std::array<std::byte, 4096> bytes{};
    const ssize_t count = ::read(line_, bytes.data(), bytes.size());
    const bool has_ended = count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
    session_.receive({bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0U}, monotonic_ns(), ears_);
    session_.tick(monotonic_ns(), ears_);
    return !has_ended;
  }

  LrfSession& session_;
  int line_;
  int baud_;
  Ears ears_;
};

}  // namespace

Result<LrfAnswer> ask_lrf(const LrfParams& params, std::int64_t patience_ns) {
  DeviceLine device(params.device, params.baud);
  Result<FileDescriptor> opened = device.open();
  if (!opened.ok()) {
    return opened.error();
  }
  const FileDescriptor line = opened.take();
  set_up_lrf_line(params, line.get());
  const auto session = make_lrf_session(params, kBeamsMax);
  auto* const sick = dynamic_cast<SickSession*>(session.get());
  if (sick != nullptr) {
    sick->only_ask();
  }
  Talk talk(*session, line.get(), params.baud);
  if (!talk.until([&] { return session->ready(); }, patience_ns)) {
    return talk.ears().is_broken ? Errc::kDeviceStatus : Errc::kDeviceSilent;
  }
  LrfAnswer answer{.params = params, .geometry = session->geometry()};
  answer.params.baud = session->line_baud() == 0 ? params.baud : session->line_baud();
  if (sick != nullptr) {
    answer.params.sick_variant = sick->found().variant;
    answer.params.sick_unit = sick->found().unit;
    answer.is_to_be_written = !sick->found().is_usual_mode;
    return answer;
  }
  answer.has_scanned = talk.until([&] { return talk.ears().has_scanned; }, patience_ns);
  answer.geometry = session->geometry();
  return answer;
}

}  // namespace odoless
