#include "drivers/io/gpio_line.hpp"

#include <fcntl.h>

#include <cerrno>

#if ODOLESS_GPIOD_MAJOR == 1
#include "drivers/io/gpio_handle_v1.hpp"
#else
#include "drivers/io/gpio_handle_v2.hpp"
#endif

namespace odoless {
namespace {

constexpr const char* kConsumer = "odoless";

}  // namespace

GpioLine::GpioLine(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}
GpioLine::GpioLine(GpioLine&&) noexcept = default;
GpioLine& GpioLine::operator=(GpioLine&&) noexcept = default;
GpioLine::~GpioLine() = default;

Result<GpioLine> GpioLine::open_input(const std::string& name, GpioPull pull) {
  auto handle = std::make_unique<Handle>();
  if (const Errc error = handle->find(name); error != Errc::kOk) {
    return error;
  }
  if (const Errc error = handle->ask_input(kConsumer, pull); error != Errc::kOk) {
    return error;
  }
  const int descriptor = handle->descriptor();
  if (::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) | O_NONBLOCK) != 0) {
    return Errc::kDeviceFailed;
  }
  return GpioLine(std::move(handle));
}

Result<GpioLine> GpioLine::open_output(const std::string& name, bool high) {
  auto handle = std::make_unique<Handle>();
  if (const Errc error = handle->find(name); error != Errc::kOk) {
    return error;
  }
  if (const Errc error = handle->ask_output(kConsumer, high); error != Errc::kOk) {
    return error;
  }
  return GpioLine(std::move(handle));
}

int GpioLine::descriptor() const { return handle_->descriptor(); }

Result<std::optional<GpioEdge>> GpioLine::read_edge() const {
  const std::optional<GpioEdge> edge = handle_->take_edge();
  if (!edge && errno != EAGAIN && errno != EINTR) {
    return Errc::kDeviceMissing;
  }
  return edge;
}

Result<bool> GpioLine::level() const {
  const int value = handle_->value();
  if (value < 0) {
    return Errc::kDeviceMissing;
  }
  return value == 1;
}

Errc GpioLine::set(bool high) { return handle_->set(high) ? Errc::kOk : Errc::kDeviceMissing; }

}  // namespace odoless
