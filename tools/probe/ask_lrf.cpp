#include "tools/probe/ask_lrf.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "drivers/io/device_line.hpp"
#include "drivers/io/serial_port.hpp"
#include "drivers/lrf/make_lrf_session.hpp"
#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr int kBeamsMax = 8192;

class Nobody final : public LrfSink {
 public:
  void on_scan(const LrfScan& /*scan*/) override {}
  void on_event(const LrfEvent& /*event*/) override {}
};

}  // namespace

Result<LrfGeometry> ask_lrf(const LrfParams& params, std::int64_t patience_ns) {
  DeviceLine device(params.device, params.baud);
  Result<FileDescriptor> opened = device.open();
  if (!opened.ok()) {
    return opened.error();
  }
  const FileDescriptor line = opened.take();
  const auto session = make_lrf_session(params, kBeamsMax);
  const std::int64_t end_ns = monotonic_ns() + patience_ns;
  Nobody nobody;
  session->reset(monotonic_ns());
  while (!session->ready() && monotonic_ns() < end_ns) {
    if (const int baud = session->line_baud(); baud != 0 && set_serial_baud(line.get(), baud) != Errc::kOk) {
      return Errc::kBaudRefused;
    }
    if (const auto request = session->transmit(); !request.empty()) {
      static_cast<void>(!::write(line.get(), request.data(), request.size()));  // the session asks again
    }
    pollfd ready{.fd = line.get(), .events = POLLIN, .revents = 0};
    const std::int64_t wait_ms = (session->next_deadline_ns() - monotonic_ns()) / 1'000'000;
    ::poll(&ready, 1, static_cast<int>(std::clamp<std::int64_t>(wait_ms, 1, 50)));
    std::array<std::byte, 4096> bytes{};
    const ssize_t count = ::read(line.get(), bytes.data(), bytes.size());
    session->receive({bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0U}, monotonic_ns(), nobody);
    session->tick(monotonic_ns(), nobody);
  }
  return session->ready() ? Result<LrfGeometry>(session->geometry()) : Errc::kDeviceSilent;
}

}  // namespace odoless
