#pragma once

// libgpiod 2.x; gpio_handle_v1.hpp is the same for 1.6. gpio_line.cpp takes the one that CMake says is here.
#include <gpiod.h>

#include <cerrno>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "drivers/io/gpio_line.hpp"

namespace odoless {

/// What differs between the two libraries: a chip, a request for one line of it, and room for an edge.
struct GpioLine::Handle {
  [[nodiscard]] Errc find(const std::string& name) {
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

  [[nodiscard]] Errc ask_input(const char* consumer, GpioPull pull) {
    constexpr gpiod_line_bias kBias[] = {GPIOD_LINE_BIAS_AS_IS, GPIOD_LINE_BIAS_PULL_DOWN, GPIOD_LINE_BIAS_PULL_UP};
    const Owned<gpiod_line_settings> settings(gpiod_line_settings_new());
    if (settings == nullptr || edge == nullptr ||
        gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT) != 0 ||
        gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH) != 0 ||
        gpiod_line_settings_set_bias(settings.get(), kBias[static_cast<std::size_t>(pull)]) != 0) {
      return Errc::kDeviceFailed;
    }
    return ask(consumer, *settings);
  }
  [[nodiscard]] Errc ask_output(const char* consumer, bool high) {
    const Owned<gpiod_line_settings> settings(gpiod_line_settings_new());
    if (settings == nullptr || gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT) != 0 ||
        gpiod_line_settings_set_output_value(settings.get(), value_of(high)) != 0) {
      return Errc::kDeviceFailed;
    }
    return ask(consumer, *settings);
  }

  [[nodiscard]] int descriptor() const { return gpiod_line_request_get_fd(request.get()); }

  /// Nothing: none waits, or the chip is gone, which errno tells apart.
  [[nodiscard]] std::optional<GpioEdge> take_edge() const {
    const int count = gpiod_line_request_read_edge_events(request.get(), edge.get(), 1);
    if (count <= 0) {
      errno = count == 0 ? EAGAIN : errno;
      return std::nullopt;
    }
    gpiod_edge_event* const event = gpiod_edge_event_buffer_get_event(edge.get(), 0);
    return GpioEdge{.monotonic_ns = static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event)),
                    .high = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE};
  }

  /// 0 or 1; less: the chip is gone.
  [[nodiscard]] int value() const {
    const gpiod_line_value found = gpiod_line_request_get_value(request.get(), offset);
    return found == GPIOD_LINE_VALUE_ERROR ? -1 : found == GPIOD_LINE_VALUE_ACTIVE ? 1 : 0;
  }
  [[nodiscard]] bool set(bool high) const {
    return gpiod_line_request_set_value(request.get(), offset, value_of(high)) == 0;
  }

 private:
  /// Frees what libgpiod gave.
  struct Free {
    void operator()(gpiod_chip* held) const { gpiod_chip_close(held); }
    void operator()(gpiod_line_settings* settings) const { gpiod_line_settings_free(settings); }
    void operator()(gpiod_line_config* config) const { gpiod_line_config_free(config); }
    void operator()(gpiod_request_config* config) const { gpiod_request_config_free(config); }
    void operator()(gpiod_line_request* held) const { gpiod_line_request_release(held); }
    void operator()(gpiod_edge_event_buffer* buffer) const { gpiod_edge_event_buffer_free(buffer); }
  };
  template <class T>
  using Owned = std::unique_ptr<T, Free>;

  static gpiod_line_value value_of(bool high) { return high ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE; }

  [[nodiscard]] Errc ask(const char* consumer, gpiod_line_settings& settings) {
    const Owned<gpiod_line_config> lines(gpiod_line_config_new());
    const Owned<gpiod_request_config> config(gpiod_request_config_new());
    if (lines == nullptr || config == nullptr ||
        gpiod_line_config_add_line_settings(lines.get(), &offset, 1, &settings) != 0) {
      return Errc::kDeviceFailed;
    }
    gpiod_request_config_set_consumer(config.get(), consumer);
    request.reset(gpiod_chip_request_lines(chip.get(), config.get(), lines.get()));
    return request != nullptr ? Errc::kOk : detail::gpio_error(errno);
  }

  unsigned offset = 0;
  Owned<gpiod_chip> chip;
  Owned<gpiod_line_request> request;
  Owned<gpiod_edge_event_buffer> edge{gpiod_edge_event_buffer_new(1)};
};

}  // namespace odoless
