#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace odoless {

/// A serial line, as the kernel tells of it.
struct SerialDevice {
  std::string path{};         ///< "/dev/ttyACM0"
  std::string stable_path{};  ///< the same wherever it is plugged in, where udev has such a name; else `path`
  std::string vendor{};       ///< of USB, hexadecimal; empty: no USB
  std::string product{};
  std::string serial{};  ///< empty: it has none
  std::string name{};    ///< what it calls itself
};

/// Serial lines that are there, sorted by path. @param root  Of the file system, for tests.
[[nodiscard]] std::vector<SerialDevice> connected_serial_devices(const std::filesystem::path& root = "/");

/// Names of CAN interfaces, sorted.
[[nodiscard]] std::vector<std::string> connected_can_interfaces(const std::filesystem::path& root = "/");

/// Names of GPIO chips, sorted.
[[nodiscard]] std::vector<std::string> connected_gpio_chips(const std::filesystem::path& root = "/");

}  // namespace odoless
