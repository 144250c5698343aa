#pragma once

// libgpiod 1.6; gpio_handle_v2.hpp is the same for 2.x. gpio_line.cpp takes the one that CMake says is here.
#include <gpiod.h>

#include <cerrno>
#include <optional>
#include <string>

#include "drivers/io/gpio_line.hpp"

namespace odoless {

/// What differs between the two libraries; a line, which the chip belongs to.
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

  [[nodiscard]] Errc find(const std::string& name) {
    errno = ENOENT;  // what a search for a name says of one that isn't there differs
    if (const auto place = detail::parse_gpio_place(name)) {
      chip = gpiod_chip_open(place->chip.c_str());
      line = chip == nullptr ? nullptr : gpiod_chip_get_line(chip, place->offset);
    } else {
      line = gpiod_line_find(name.c_str());
    }
    return line != nullptr ? Errc::kOk : detail::gpio_error(errno);
  }

  [[nodiscard]] Errc ask_input(const char* consumer, GpioPull pull) const {
    constexpr int kFlags[] = {0, GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN, GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP};
    const int flags = kFlags[static_cast<std::size_t>(pull)];
    return gpiod_line_request_both_edges_events_flags(line, consumer, flags) == 0 ? Errc::kOk
                                                                                  : detail::gpio_error(errno);
  }
  [[nodiscard]] Errc ask_output(const char* consumer, bool high) const {
    return gpiod_line_request_output(line, consumer, high ? 1 : 0) == 0 ? Errc::kOk : detail::gpio_error(errno);
  }

  [[nodiscard]] int descriptor() const { return gpiod_line_event_get_fd(line); }

  /// Nothing: none waits, or the chip is gone, which errno tells apart.
  [[nodiscard]] std::optional<GpioEdge> take_edge() const {
    gpiod_line_event event{};
    if (gpiod_line_event_read_fd(descriptor(), &event) != 0) {
      return std::nullopt;
    }
    return GpioEdge{.monotonic_ns = event.ts.tv_sec * std::int64_t{1'000'000'000} + event.ts.tv_nsec,
                    .high = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE};
  }

  /// 0 or 1; less: the chip is gone.
  [[nodiscard]] int value() const { return gpiod_line_get_value(line); }
  [[nodiscard]] bool set(bool high) const { return gpiod_line_set_value(line, high ? 1 : 0) == 0; }

  gpiod_chip* chip = nullptr;
  gpiod_line* line = nullptr;
};

}  // namespace odoless
