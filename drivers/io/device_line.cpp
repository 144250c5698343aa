#include "drivers/io/device_line.hpp"

#include "drivers/io/serial_port.hpp"
#include "drivers/io/tcp_client.hpp"
#include "drivers/io/udp_listener.hpp"

namespace odoless {

Result<FileDescriptor> DeviceLine::open(int priority) {
  usb_.reset();
  const Result<DeviceAddress> address = parse_device_address(text_);
  if (!address.ok()) {
    return address.error();
  }
  if (const auto* const serial = std::get_if<SerialAddress>(&address.value())) {
    return open_serial({.path = serial->path, .baud = baud_});
  }
  if (const auto* const tcp = std::get_if<TcpAddress>(&address.value())) {
    return open_host(*tcp);
  }
  if (const auto* const udp = std::get_if<UdpAddress>(&address.value())) {
    return open_udp(*udp);
  }
  Result<std::unique_ptr<UsbSerial>> opened = UsbSerial::open(*std::get_if<UsbAddress>(&address.value()), priority);
  if (!opened.ok()) {
    return opened.error();
  }
  usb_ = opened.take();
  return usb_->take_line();
}

// A host may have an address of each kind and listen at one of them.
Result<FileDescriptor> DeviceLine::open_host(const TcpAddress& address) {
  const Result<std::vector<std::string>> hosts = lookup_.find(address.host);
  if (!hosts.ok()) {
    return hosts.error();
  }
  Errc error = Errc::kDeviceMissing;
  for (const std::string& host : hosts.value()) {
    Result<FileDescriptor> opened = open_tcp({.host = host, .port = address.port});
    if (opened.ok()) {
      return opened;
    }
    error = opened.error();
  }
  return error;
}

}  // namespace odoless
