#include "drivers/io/device_advice.hpp"

#include <grp.h>
#include <sys/stat.h>

#include <variant>

#include "drivers/io/device_address.hpp"

namespace odoless {
namespace {

std::string advice_on(Errc error, const DeviceAddress& address) {
  const auto* const serial = std::get_if<SerialAddress>(&address);
  if (std::holds_alternative<UdpAddress>(address)) {
    return error == Errc::kDeviceMissing ? "udp:// takes an address of this machine, such as 127.0.0.1 or 0.0.0.0" : "";
  }
  if (error == Errc::kDeviceDenied) {
    return serial != nullptr ? group_advice(serial->path)
                             : "rights on USB devices are given by udev rules (config/udev/60-odoless.rules)";
  }
  if (error != Errc::kDeviceMissing) {
    return "";
  }
  return std::holds_alternative<TcpAddress>(address) ? "nobody answers at that address, or its name is not known"
                                                     : "`odoless probe` lists what is connected";
}

}  // namespace

std::string group_advice(const std::string& path) {
  struct stat file {};
  constexpr mode_t kReadWrite = S_IRGRP | S_IWGRP;
  if (::stat(path.c_str(), &file) != 0 || (file.st_mode & kReadWrite) != kReadWrite) {
    return "";
  }
  const group* const owner = ::getgrgid(file.st_gid);  // NOLINT(concurrency-mt-unsafe): one thread opens devices
  const std::string name = owner != nullptr ? owner->gr_name : std::to_string(file.st_gid);
  return "it belongs to the group " + name + ": `sudo usermod -aG " + name + " $USER`, then log in anew";
}

std::string device_error_text(Errc error, std::string_view address) {
  const Result<DeviceAddress> parsed = parse_device_address(address);
  const std::string advice = parsed.ok() ? advice_on(error, parsed.value()) : "";
  return describe(error) + (advice.empty() ? "" : "; " + advice);
}

}  // namespace odoless
