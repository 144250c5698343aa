// libgpiod 2.x; gpio_line_v1.cpp is the same for 1.6. CMake says which is here.
#if ODOLESS_GPIOD_MAJOR == 2

#include <fcntl.h>
#include <gpiod.h>

#include <cerrno>
#include <filesystem>

#include "drivers/io/gpio_line.hpp"

namespace odoless {
namespace {

/// Frees what libgpiod gave.
struct Free {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
  void operator()(gpiod_line_settings* settings) const { gpiod_line_settings_free(settings); }
  void operator()(gpiod_line_config* config) const { gpiod_line_config_free(config); }
  void operator()(gpiod_request_config* config) const { gpiod_request_config_free(config); }
  void operator()(gpiod_line_request* request) const { gpiod_line_request_release(request); }
  void operator()(gpiod_edge_event_buffer* buffer) const { gpiod_edge_event_buffer_free(buffer); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

gpiod_line_bias bias_of(GpioPull pull) {
  switch (pull) {
    case GpioPull::kDown:
      return GPIOD_LINE_BIAS_PULL_DOWN;
    case GpioPull::kUp:
      return GPIOD_LINE_BIAS_PULL_UP;
    case GpioPull::kNone:
      break;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

}  // namespace

struct GpioLine::Handle {
  Errc find(const std::string& name) {
    if (const auto place = detail::parse_gpio_place(name)) {
      offset = place->offset;
      chip.reset(gpiod_chip_open(place->chip.c_str()));
      return chip != nullptr ? Errc::kOk : detail::gpio_error(errno);
    }
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/dev", error)) {
      if (!gpiod_is_gpiochip_device(entry.path().c_str())) {
        continue;
      }
      chip.reset(gpiod_chip_open(entry.path().c_str()));
      const int found = chip != nullptr ? gpiod_chip_get_line_offset_from_name(chip.get(), name.c_str()) : -1;
      if (found >= 0) {
        offset = static_cast<unsigned>(found);
        return Errc::kOk;
      }
    }
    return Errc::kDeviceMissing;
  }

  Errc ask(gpiod_line_settings& settings) {
    const Owned<gpiod_line_config> lines(gpiod_line_config_new());
    const Owned<gpiod_request_config> config(gpiod_request_config_new());
    if (lines == nullptr || config == nullptr ||
        gpiod_line_config_add_line_settings(lines.get(), &offset, 1, &settings) != 0) {
      return Errc::kDeviceFailed;
    }
    gpiod_request_config_set_consumer(config.get(), "odoless");
    request.reset(gpiod_chip_request_lines(chip.get(), config.get(), lines.get()));
    return request != nullptr ? Errc::kOk : detail::gpio_error(errno);
  }

  unsigned offset = 0;
  Owned<gpiod_chip> chip;
  Owned<gpiod_line_request> request;
  Owned<gpiod_edge_event_buffer> edge{gpiod_edge_event_buffer_new(1)};
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
  const Owned<gpiod_line_settings> settings(gpiod_line_settings_new());
  if (settings == nullptr || handle->edge == nullptr ||
      gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT) != 0 ||
      gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH) != 0 ||
      gpiod_line_settings_set_bias(settings.get(), bias_of(pull)) != 0) {
    return Errc::kDeviceFailed;
  }
  if (const Errc error = handle->ask(*settings); error != Errc::kOk) {
    return error;
  }
  const int descriptor = gpiod_line_request_get_fd(handle->request.get());
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
  const Owned<gpiod_line_settings> settings(gpiod_line_settings_new());
  const gpiod_line_value value = high ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  if (settings == nullptr || gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT) != 0 ||
      gpiod_line_settings_set_output_value(settings.get(), value) != 0) {
    return Errc::kDeviceFailed;
  }
  if (const Errc error = handle->ask(*settings); error != Errc::kOk) {
    return error;
  }
  return GpioLine(std::move(handle));
}

int GpioLine::descriptor() const { return gpiod_line_request_get_fd(handle_->request.get()); }

Result<std::optional<GpioEdge>> GpioLine::read_edge() const {
  const int count = gpiod_line_request_read_edge_events(handle_->request.get(), handle_->edge.get(), 1);
  if (count <= 0) {
    if (count == 0 || errno == EAGAIN || errno == EINTR) {
      return std::optional<GpioEdge>();
    }
    return Errc::kDeviceMissing;
  }
  gpiod_edge_event* const event = gpiod_edge_event_buffer_get_event(handle_->edge.get(), 0);
  return std::optional(GpioEdge{.monotonic_ns = static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event)),
                                .high = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE});
}

Result<bool> GpioLine::level() const {
  const gpiod_line_value value = gpiod_line_request_get_value(handle_->request.get(), handle_->offset);
  if (value == GPIOD_LINE_VALUE_ERROR) {
    return Errc::kDeviceMissing;
  }
  return value == GPIOD_LINE_VALUE_ACTIVE;
}

Errc GpioLine::set(bool high) {
  const gpiod_line_value value = high ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  return gpiod_line_request_set_value(handle_->request.get(), handle_->offset, value) == 0 ? Errc::kOk
                                                                                           : Errc::kDeviceMissing;
}

}  // namespace odoless

#endif
