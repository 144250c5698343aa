#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/io/device_address.hpp"
#include "drivers/io/file_descriptor.hpp"
#include "rt/real_time_thread.hpp"

struct libusb_context;
struct libusb_device_handle;
struct libusb_transfer;

namespace odoless {

/// A USB device of the class CDC-ACM [usbcdc120], taken from the kernel's driver and used directly, without a
/// /dev/ttyACM*: found by vendor, product and serial number, wherever it is plugged in.
///
/// libusb allocates and locks, so a thread of its own moves the bytes between the device and a socket, whose other end
/// is read and written like a serial line. Unplugged: that end reads 0 bytes. Closed by its user: the thread ends.
/// Bytes that nobody reads are dropped by whole packets, as on a serial line.
///
/// Thread: made and destroyed by one ordinary thread; the line may be used by any one, in real time.
class UsbSerial {
 public:
  /// Errors: Errc::kDeviceMissing, kDeviceDenied (permissions of /dev/bus/usb), kDeviceBusy, kNotSerial (no CDC-ACM
  /// device), kDeviceFailed. Waits for the device, a second at most.
  /// @param priority  Of SCHED_FIFO for the thread that moves bytes; 0, or where it is refused: an ordinary one.
  [[nodiscard]] static Result<std::unique_ptr<UsbSerial>> open(const UsbAddress& address, int priority);

  UsbSerial(const UsbSerial&) = delete;
  UsbSerial& operator=(const UsbSerial&) = delete;
  /// Gives the device back to the kernel's driver; the line reads 0 bytes from now on.
  ~UsbSerial();

  /// The end to be used; once.
  [[nodiscard]] FileDescriptor take_line() { return std::move(line_); }

 private:
  static constexpr std::size_t kReads = 16;  ///< requests that wait in the kernel, so that none is late

  /// Where the bytes go, as the device's descriptors say.
  struct Layout {
    int control_interface = -1;
    int data_interface = -1;
    std::uint8_t in_endpoint = 0;
    std::uint8_t out_endpoint = 0;
    int packet_bytes = 0;
  };

  UsbSerial() = default;
  [[nodiscard]] Errc find(const UsbAddress& address);
  [[nodiscard]] bool has_serial(const UsbAddress& address) const;
  [[nodiscard]] std::optional<Layout> layout() const;
  [[nodiscard]] Errc claim();
  [[nodiscard]] Errc start(int priority);
  void pump();
  [[nodiscard]] bool submit_reads();
  void wait(bool for_line);
  void take_from_line();
  void end_transfers();
  void on_read(libusb_transfer& transfer);
  void on_written(const libusb_transfer& transfer);

  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  Layout layout_;
  bool claimed_control_ = false;
  bool claimed_data_ = false;
  FileDescriptor line_;  ///< the user's end
  FileDescriptor pump_;  ///< ours
  std::array<libusb_transfer*, kReads> reads_{};
  libusb_transfer* write_ = nullptr;
  std::vector<unsigned char> read_buffer_;
  std::array<unsigned char, 4096> write_buffer_{};
  int pending_ = 0;  ///< requests in the kernel
  bool writing_ = false;
  bool gone_ = false;
  std::unique_ptr<RealTimeThread> thread_;
};

}  // namespace odoless
