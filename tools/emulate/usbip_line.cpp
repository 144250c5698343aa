#include "tools/emulate/usbip_line.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <optional>
#include <sstream>

#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr const char* kHost = "/sys/devices/platform/vhci_hcd.0/";
constexpr int kFullSpeed = 2;           // enum usb_device_speed of <linux/usb/ch9.h>
constexpr int kDeviceNumber = 0x10002;  // bus 1, device 2, on a machine that there isn't

/// A free port for devices of full speed: "hs  0000 004 000 00000000 000000 0-0", where 4 is VDEV_ST_NULL.
std::optional<int> free_port() {
  std::ifstream status(std::string(kHost) + "status");
  for (std::string line; std::getline(status, line);) {
    std::istringstream fields(line);
    std::string speed;
    std::string port;
    std::string state;
    if (fields >> speed >> port >> state && speed == "hs" && state == "004") {
      return std::stoi(port);
    }
  }
  return std::nullopt;
}

}  // namespace

UsbipLine::UsbipLine(const UsbIdentity& identity)
    : device_(identity),
      path_(fmt::format("usb://{:04x}:{:04x}/{}", identity.vendor, identity.product, identity.serial)) {
  const std::optional<int> port = free_port();
  if (!port) {
    throw CannotCreateError(fmt::format("{}status: no free port (modprobe vhci-hcd)", kHost));
  }
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw CannotCreateError("a pair of sockets: " + system_reason(errno));
  }
  kernel_.reset(ends[0]);
  const FileDescriptor given(ends[1]);  // the kernel keeps the socket
  std::ofstream attach(std::string(kHost) + "attach");
  attach << fmt::format("{} {} {} {}", *port, given.get(), kDeviceNumber, kFullSpeed) << std::flush;
  if (!attach) {
    throw CannotCreateError(fmt::format("{}attach: cannot be written (root may)", kHost));
  }
}

bool UsbipLine::has_client() {
  exchange();
  return device_.is_open();
}

std::string UsbipLine::read() {
  exchange();
  return device_.take_received();
}

std::size_t UsbipLine::write(std::string_view bytes) {
  const std::size_t size_bytes = device_.send(bytes);
  exchange();
  return size_bytes;
}

void UsbipLine::exchange() {
  std::array<char, 16384> bytes{};
  for (ssize_t count = 1; count > 0;) {
    count = ::recv(kernel_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    device_.receive({bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0});
  }
  unsent_ += device_.take_output();
  const ssize_t sent = ::send(kernel_.get(), unsent_.data(), unsent_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  unsent_.erase(0, sent > 0 ? static_cast<std::size_t>(sent) : 0);
}

}  // namespace odoless
