#include "tools/probe/connected.hpp"

#include <algorithm>
#include <fstream>

namespace odoless {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& path) {
  std::string line;
  std::ifstream file(path);
  std::getline(file, line);
  return line;
}

/// Names in a folder, sorted; none where there is no such folder.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// A port that a driver only reserves (/dev/ttyS0 to ttyS3 of a machine without any) has the type 0, PORT_UNKNOWN.
bool is_there(const fs::path& tty) {
  std::error_code error;
  return fs::exists(tty / "device", error) && first_line(tty / "type") != "0";
}

std::string stable_path_of(const std::string& name, const fs::path& root) {
  for (const char* const folder : {"dev/odoless", "dev/serial/by-id"}) {
    for (const std::string& link : names_in(root / folder)) {
      std::error_code error;
      if (fs::read_symlink(root / folder / link, error).filename() == name) {
        return (fs::path("/") / folder / link).string();
      }
    }
  }
  return "/dev/" + name;
}

/// What the USB device says that a serial line is part of.
void describe_usb(const fs::path& tty, SerialDevice& device) {
  std::error_code error;
  for (fs::path folder = fs::canonical(tty / "device", error); folder.has_relative_path();
       folder = folder.parent_path()) {
    if (fs::exists(folder / "idVendor", error)) {
      device.vendor = first_line(folder / "idVendor");
      device.product = first_line(folder / "idProduct");
      device.serial = first_line(folder / "serial");
      device.name = first_line(folder / "manufacturer") + " " + first_line(folder / "product");
      return;
    }
  }
}

}  // namespace

std::vector<SerialDevice> connected_serial_devices(const fs::path& root) {
  std::vector<SerialDevice> devices;
  const fs::path ttys = root / "sys/class/tty";
  for (const std::string& name : names_in(ttys)) {
    if (is_there(ttys / name)) {
      SerialDevice device{.path = "/dev/" + name, .stable_path = stable_path_of(name, root)};
      describe_usb(ttys / name, device);
      devices.push_back(std::move(device));
    }
  }
  return devices;
}

std::vector<std::string> connected_can_interfaces(const fs::path& root) {
  constexpr const char* kCan = "280";  // ARPHRD_CAN of <linux/if_arp.h>
  std::vector<std::string> names = names_in(root / "sys/class/net");
  std::erase_if(names,
                [&](const std::string& name) { return first_line(root / "sys/class/net" / name / "type") != kCan; });
  return names;
}

std::vector<std::string> connected_gpio_chips(const fs::path& root) {
  std::vector<std::string> names = names_in(root / "sys/bus/gpio/devices");
  std::erase_if(names, [](const std::string& name) { return !name.starts_with("gpiochip"); });
  return names;
}

}  // namespace odoless
