#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace odoless {

/// A GPIO chip of Linux's gpio-sim, driven from the outside: what is beyond the pins. Needs root, and the module
/// gpio-sim.
///
/// Thread: one.
class GpioSimChip {
 public:
  /// Makes a chip with these names of lines, or takes one of that name which is there already.
  /// @throws CannotCreateError that says what is missing.
  GpioSimChip(const std::string& name, std::span<const std::string> lines);
  GpioSimChip(const GpioSimChip&) = delete;
  GpioSimChip& operator=(const GpioSimChip&) = delete;
  /// Removes the chip, unless one of its lines is in use: Linux 6.1 doesn't survive that.
  ~GpioSimChip();

  /// Its name in /dev.
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Puts a level on an input, as a wire would. @throws IoError: the chip is gone.
  void set(std::size_t line, bool high);
  /// What is on the line; nothing: the chip is gone.
  [[nodiscard]] std::optional<bool> value(std::size_t line) const;

 private:
  void make(std::span<const std::string> lines);
  [[nodiscard]] bool is_in_use() const;
  [[nodiscard]] std::string pin(std::size_t line) const;

  std::string folder_;  ///< in configfs
  std::string device_;
  std::string pins_;  ///< folder in sysfs
  std::size_t lines_;
};

}  // namespace odoless
