#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace odoless {

/// What a USB device says of itself.
struct UsbIdentity {
  std::uint16_t vendor = 0x15d1;  ///< Hokuyo
  std::uint16_t product = 0;
  std::string manufacturer = "Hokuyo Data Flex for USB";
  std::string product_text = "URG-Series USB Driver";
  std::string serial = "H0000001";
};

/// A USB serial device (CDC-ACM [usbcdc120]) that speaks USB/IP (Documentation/usb/usbip_protocol.rst of Linux),
/// without a line: the host's packets and the device's bytes come in, packets and the host's bytes go out.
///
/// Full speed, one configuration: an interface for control and one for data. One thread.
class UsbCdcDevice {
 public:
  explicit UsbCdcDevice(UsbIdentity identity) : identity_(std::move(identity)) {}

  /// Bytes of the USB/IP connection; split anywhere.
  void receive(std::string_view bytes);
  /// Bytes for the USB/IP connection.
  [[nodiscard]] std::string take_output();

  /// Whether the host has the serial line open (DTR).
  [[nodiscard]] bool is_open() const { return open_; }
  /// What the host has written to the serial line.
  [[nodiscard]] std::string take_received();
  /// Sends to the host; returns how many bytes found room.
  [[nodiscard]] std::size_t send(std::string_view bytes);

 private:
  struct Request {
    std::uint32_t sequence = 0;
    std::size_t size_bytes = 0;
  };

  [[nodiscard]] bool take_packet();
  void submit(std::string_view header, std::string_view data);
  void unlink(std::uint32_t sequence, std::uint32_t victim);
  void control(std::uint32_t sequence, std::string_view setup, std::string_view data, std::size_t size_bytes);
  [[nodiscard]] std::string descriptor(int type, int index) const;
  void reply(std::uint32_t sequence, std::int32_t status, std::size_t actual_bytes, std::string_view data);
  void serve_reads();

  UsbIdentity identity_;
  std::string input_;
  std::string output_;
  std::string to_host_;
  std::string from_host_;
  std::string line_coding_ = std::string("\x00\xc2\x01\x00\x00\x00\x08", 7);
  std::deque<Request> reads_;
  std::deque<std::uint32_t> notifications_;  ///< requests for what never happens
  bool open_ = false;
};

}  // namespace odoless
