// libgpiod 1.6; gpio_line_v2.cpp is the same for 2.x. CMake says which is here.
#if ODOLESS_GPIOD_MAJOR == 1

#include <fcntl.h>
#include <gpiod.h>

#include <cerrno>

#include "drivers/io/gpio_line.hpp"

namespace odoless {
namespace {

constexpr const char* kConsumer = "odoless";

int flags_of(GpioPull pull) {
  switch (pull) {
    case GpioPull::kDown:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    case GpioPull::kUp:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case GpioPull::kNone:
      break;
  }
  return 0;
}

}  // namespace

struct GpioLine::Handle {
  Handle() = default;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle(Handle&&) = delete;
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (line != nullptr) {
      gpiod_line_close_chip(line);  // which releases the line, too
    } else if (chip != nullptr) {
      gpiod_chip_close(chip);
    }
  }

  Errc find(const std::string& name) {
    errno = ENOENT;  // what a search for a name says of one that isn't there differs
    if (const auto place = detail::parse_gpio_place(name)) {
      chip = gpiod_chip_open(place->chip.c_str());
      line = chip == nullptr ? nullptr : gpiod_chip_get_line(chip, place->offset);
    } else {
      line = gpiod_line_find(name.c_str());
    }
    return line != nullptr ? Errc::kOk : detail::gpio_error(errno);
  }

  gpiod_chip* chip = nullptr;
  gpiod_line* line = nullptr;
};

GpioLine::GpioLine(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}
GpioLine::GpioLine(GpioLine&&) noexcept = default;
GpioLine& GpioLine::operator=(GpioLine&&) noexcept = default;
GpioLine::~GpioLine() = default;

Result<GpioLine> GpioLine::open_input(const std::string& name, GpioPull pull) {
  auto handle = std::make_unique<Handle>();
  if (const Errc error = handle->find(name); error != Errc::kOk) {
    return error;
  }
  if (gpiod_line_request_both_edges_events_flags(handle->line, kConsumer, flags_of(pull)) != 0) {
    return detail::gpio_error(errno);
  }
  const int descriptor = gpiod_line_event_get_fd(handle->line);
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
  if (gpiod_line_request_output(handle->line, kConsumer, high ? 1 : 0) != 0) {
    return detail::gpio_error(errno);
  }
  return GpioLine(std::move(handle));
}

int GpioLine::descriptor() const { return gpiod_line_event_get_fd(handle_->line); }

Result<std::optional<GpioEdge>> GpioLine::read_edge() const {
  gpiod_line_event event{};
  if (gpiod_line_event_read_fd(descriptor(), &event) != 0) {
    if (errno == EAGAIN || errno == EINTR) {
      return std::optional<GpioEdge>();
    }
    return Errc::kDeviceMissing;
  }
  return std::optional(GpioEdge{.monotonic_ns = event.ts.tv_sec * std::int64_t{1'000'000'000} + event.ts.tv_nsec,
                                .high = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE});
}

Result<bool> GpioLine::level() const {
  const int value = gpiod_line_get_value(handle_->line);
  if (value < 0) {
    return Errc::kDeviceMissing;
  }
  return value == 1;
}

Errc GpioLine::set(bool high) {
  return gpiod_line_set_value(handle_->line, high ? 1 : 0) == 0 ? Errc::kOk : Errc::kDeviceMissing;
}

}  // namespace odoless

#endif
