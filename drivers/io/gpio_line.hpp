#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.hpp"

namespace odoless {

/// Where an input goes by itself when nothing drives it; not every chip can.
enum class GpioPull : std::uint8_t { kNone, kDown, kUp };

/// A change of an input's level.
struct GpioEdge {
  std::int64_t monotonic_ns = 0;  ///< CLOCK_MONOTONIC, taken by the kernel when the interrupt came
  bool high = false;              ///< the level that it changed to
};

/// One line of a GPIO chip, used by this process alone, by libgpiod 1.6 or 2.x.
///
/// A line is named "CHIP:OFFSET", where CHIP is a path or a name of /dev ("gpiochip0:17"), or by the name that its
/// board gives it, which the first chip that knows it decides. Levels are those on the pin: nothing is inverted.
///
/// Thread: one at a time. Real time: `read_edge`, `level` and `set` are one system call each (read, ioctl, ioctl) and
/// do not allocate; opening and closing is for ordinary threads.
class GpioLine {
 public:
  /// An input that tells of both edges. Errors: Errc::kDeviceMissing (no such chip or line), kDeviceBusy,
  /// kDeviceDenied, kDeviceFailed.
  [[nodiscard]] static Result<GpioLine> open_input(const std::string& name, GpioPull pull);
  /// An output that is `high` from the first moment. The same errors.
  [[nodiscard]] static Result<GpioLine> open_output(const std::string& name, bool high);

  GpioLine(GpioLine&&) noexcept;
  GpioLine& operator=(GpioLine&&) noexcept;
  GpioLine(const GpioLine&) = delete;
  GpioLine& operator=(const GpioLine&) = delete;
  ~GpioLine();  ///< gives the line back; what becomes of an output's level is the chip's affair

  /// Of an input: readable when an edge waits.
  [[nodiscard]] int descriptor() const;
  /// Of an input: the oldest edge that waits, or none. The kernel keeps 16 and drops the newest beyond (libgpiod 1.6),
  /// or the oldest (2.x). Errors: Errc::kDeviceMissing, the chip is gone.
  [[nodiscard]] Result<std::optional<GpioEdge>> read_edge() const;
  /// Whether it is high now. Errors: Errc::kDeviceMissing.
  [[nodiscard]] Result<bool> level() const;
  /// Of an output. Errors: Errc::kDeviceMissing.
  [[nodiscard]] Errc set(bool high);

 private:
  struct Handle;  ///< of libgpiod
  explicit GpioLine(std::unique_ptr<Handle> handle);
  std::unique_ptr<Handle> handle_;
};

namespace detail {

/// "gpiochip0:17" taken apart; nothing: a name of a line.
struct GpioPlace {
  std::string chip;  ///< a path
  unsigned offset = 0;
};
[[nodiscard]] std::optional<GpioPlace> parse_gpio_place(const std::string& name);

/// Of opening a line.
[[nodiscard]] Errc gpio_error(int error_number);

}  // namespace detail
}  // namespace odoless
