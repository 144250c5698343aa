#include "drivers/io/usb_serial.hpp"

#include <libusb.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <string>

namespace odoless {
namespace {

constexpr unsigned kControlTimeout_ms = 300;
constexpr std::uint8_t kSetLineCoding = 0x20;
constexpr std::uint8_t kSetControlLineState = 0x22;
constexpr std::uint8_t kClassRequestOut = 0x21;
constexpr std::uint16_t kTerminalReady = 0x3;  // DTR and RTS

Errc usb_error(int error) {
  switch (error) {
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
    case LIBUSB_ERROR_IO:
      return Errc::kDeviceMissing;
    case LIBUSB_ERROR_ACCESS:
      return Errc::kDeviceDenied;
    case LIBUSB_ERROR_BUSY:
      return Errc::kDeviceBusy;
    default:
      return Errc::kDeviceFailed;
  }
}

/// All devices that are plugged in.
class DeviceList {
 public:
  explicit DeviceList(libusb_context* context) : count_(libusb_get_device_list(context, &devices_)) {}
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;
  ~DeviceList() {
    if (count_ >= 0) {
      libusb_free_device_list(devices_, 1);
    }
  }
  [[nodiscard]] libusb_device** begin() const { return devices_; }
  [[nodiscard]] libusb_device** end() const { return devices_ + std::max<ssize_t>(count_, 0); }

 private:
  libusb_device** devices_ = nullptr;
  ssize_t count_;
};

}  // namespace

Result<std::unique_ptr<UsbSerial>> UsbSerial::open(const UsbAddress& address, int priority) {
  std::unique_ptr<UsbSerial> device(new UsbSerial());
  if (libusb_init(&device->context_) != 0) {
    return Errc::kDeviceFailed;
  }
  if (const Errc error = device->find(address); error != Errc::kOk) {
    return error;
  }
  if (const Errc error = device->claim(); error != Errc::kOk) {
    return error;
  }
  if (const Errc error = device->start(priority); error != Errc::kOk) {
    return error;
  }
  return device;
}

UsbSerial::~UsbSerial() {
  line_.reset();
  if (thread_) {
    ::shutdown(pump_.get(), SHUT_RDWR);
    thread_->join();
  }
  for (libusb_transfer* const transfer : reads_) {
    libusb_free_transfer(transfer);
  }
  libusb_free_transfer(write_);
  if (claimed_data_) {
    libusb_release_interface(handle_, layout_.data_interface);
  }
  if (claimed_control_) {
    libusb_release_interface(handle_, layout_.control_interface);
  }
  if (handle_ != nullptr) {
    libusb_close(handle_);
  }
  if (context_ != nullptr) {
    libusb_exit(context_);
  }
}

Errc UsbSerial::find(const UsbAddress& address) {
  Errc error = Errc::kDeviceMissing;
  for (libusb_device* const device : DeviceList(context_)) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != 0 || descriptor.idVendor != address.vendor ||
        descriptor.idProduct != address.product) {
      continue;
    }
    if (const int refused = libusb_open(device, &handle_); refused != 0) {
      error = usb_error(refused);
      handle_ = nullptr;
      continue;
    }
    if (has_serial(address)) {
      return Errc::kOk;
    }
    libusb_close(handle_);
    handle_ = nullptr;
  }
  return error;
}

bool UsbSerial::has_serial(const UsbAddress& address) const {
  libusb_device_descriptor descriptor{};
  std::array<unsigned char, 256> text{};
  if (address.serial.empty()) {
    return true;
  }
  if (libusb_get_device_descriptor(libusb_get_device(handle_), &descriptor) != 0 || descriptor.iSerialNumber == 0) {
    return false;
  }
  const int size =
      libusb_get_string_descriptor_ascii(handle_, descriptor.iSerialNumber, text.data(), static_cast<int>(text.size()));
  return size > 0 && std::equal(address.serial.begin(), address.serial.end(), text.begin(), text.begin() + size);
}

std::optional<UsbSerial::Layout> UsbSerial::layout() const {
  libusb_config_descriptor* config = nullptr;
  if (libusb_get_active_config_descriptor(libusb_get_device(handle_), &config) != 0) {
    return std::nullopt;
  }
  Layout layout;
  for (int i = 0; i < config->bNumInterfaces; ++i) {
    if (config->interface[i].num_altsetting < 1) {
      continue;
    }
    const libusb_interface_descriptor& interface = config->interface[i].altsetting[0];
    if (interface.bInterfaceClass == LIBUSB_CLASS_COMM && layout.control_interface < 0) {
      layout.control_interface = interface.bInterfaceNumber;
    }
    if (interface.bInterfaceClass != LIBUSB_CLASS_DATA || layout.data_interface >= 0) {
      continue;
    }
    for (int j = 0; j < interface.bNumEndpoints; ++j) {
      const libusb_endpoint_descriptor& endpoint = interface.endpoint[j];
      if ((endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_BULK) {
        const bool is_in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == LIBUSB_ENDPOINT_IN;
        (is_in ? layout.in_endpoint : layout.out_endpoint) = endpoint.bEndpointAddress;
        layout.packet_bytes = is_in ? endpoint.wMaxPacketSize & 0x7ff : layout.packet_bytes;
      }
    }
    layout.data_interface = interface.bInterfaceNumber;
  }
  libusb_free_config_descriptor(config);
  const bool complete = layout.control_interface >= 0 && layout.data_interface >= 0 && layout.in_endpoint != 0 &&
                        layout.out_endpoint != 0 && layout.packet_bytes > 0;
  return complete ? std::optional(layout) : std::nullopt;
}

// The line coding has no effect on a device without a real line behind it, but some wait for it before they send.
Errc UsbSerial::claim() {
  const std::optional<Layout> found = layout();
  if (!found) {
    return Errc::kNotSerial;
  }
  layout_ = *found;
  libusb_set_auto_detach_kernel_driver(handle_, 1);
  if (const int error = libusb_claim_interface(handle_, layout_.control_interface); error != 0) {
    return usb_error(error);
  }
  claimed_control_ = true;
  if (const int error = libusb_claim_interface(handle_, layout_.data_interface); error != 0) {
    return usb_error(error);
  }
  claimed_data_ = true;
  std::array<unsigned char, 7> coding{0x00, 0xc2, 0x01, 0x00, 0, 0, 8};  // 115200 baud, 8N1
  const auto interface = static_cast<std::uint16_t>(layout_.control_interface);
  static_cast<void>(libusb_control_transfer(handle_, kClassRequestOut, kSetLineCoding, 0, interface, coding.data(),
                                            coding.size(), kControlTimeout_ms));
  const int error = libusb_control_transfer(handle_, kClassRequestOut, kSetControlLineState, kTerminalReady, interface,
                                            nullptr, 0, kControlTimeout_ms);
  return error >= 0 || error == LIBUSB_ERROR_PIPE ? Errc::kOk : usb_error(error);  // a stall: it doesn't know it
}

Errc UsbSerial::start(int priority) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return Errc::kDeviceFailed;
  }
  line_.reset(ends[0]);
  pump_.reset(ends[1]);
  read_buffer_.resize(kReads * static_cast<std::size_t>(layout_.packet_bytes));
  for (libusb_transfer*& transfer : reads_) {
    transfer = libusb_alloc_transfer(0);
  }
  write_ = libusb_alloc_transfer(0);
  thread_ = std::make_unique<RealTimeThread>(ThreadParams{.name = "odo-usb", .priority = priority});
  return thread_->start([this] { pump(); }) == 0 ? Errc::kOk : Errc::kDeviceFailed;
}

void UsbSerial::pump() {
  gone_ = !submit_reads();
  while (!gone_) {
    wait(!writing_);
    timeval at_once{};
    libusb_handle_events_timeout_completed(context_, &at_once, nullptr);
    if (!writing_) {
      take_from_line();
    }
  }
  end_transfers();
  ::shutdown(pump_.get(), SHUT_RDWR);
}

// A request for one packet each: one for more would keep back a packet that is full until the next one comes.
bool UsbSerial::submit_reads() {
  const auto callback = [](libusb_transfer* transfer) {
    static_cast<UsbSerial*>(transfer->user_data)->on_read(*transfer);
  };
  for (std::size_t i = 0; i < kReads; ++i) {
    unsigned char* const buffer = read_buffer_.data() + i * static_cast<std::size_t>(layout_.packet_bytes);
    libusb_fill_bulk_transfer(reads_[i], handle_, layout_.in_endpoint, buffer, layout_.packet_bytes, callback, this, 0);
    if (libusb_submit_transfer(reads_[i]) != 0) {
      return false;
    }
    ++pending_;
  }
  return true;
}

void UsbSerial::wait(bool for_line) {
  constexpr std::size_t kMost = 8;
  std::array<pollfd, kMost> ready{};
  std::size_t count = 0;
  ready[count++] = {.fd = pump_.get(), .events = static_cast<std::int16_t>(for_line ? POLLIN : 0), .revents = 0};
  if (const libusb_pollfd** const descriptors = libusb_get_pollfds(context_); descriptors != nullptr) {
    for (const libusb_pollfd** next = descriptors; *next != nullptr && count < kMost; ++next) {
      ready[count++] = {.fd = (*next)->fd, .events = (*next)->events, .revents = 0};
    }
    libusb_free_pollfds(descriptors);
  }
  ::poll(ready.data(), count, -1);
  gone_ = gone_ || (ready[0].revents & (POLLHUP | POLLERR)) != 0;
}

void UsbSerial::take_from_line() {
  const ssize_t size = ::recv(pump_.get(), write_buffer_.data(), write_buffer_.size(), 0);
  if (size <= 0) {
    gone_ = gone_ || size == 0 || (errno != EAGAIN && errno != EINTR);
    return;
  }
  const auto callback = [](libusb_transfer* transfer) {
    static_cast<UsbSerial*>(transfer->user_data)->on_written(*transfer);
  };
  libusb_fill_bulk_transfer(write_, handle_, layout_.out_endpoint, write_buffer_.data(), static_cast<int>(size),
                            callback, this, 0);
  writing_ = libusb_submit_transfer(write_) == 0;
  pending_ += writing_ ? 1 : 0;
  gone_ = gone_ || !writing_;
}

// Not for ever: a device that is pulled out answers each of them, but nobody vouches for every host controller.
void UsbSerial::end_transfers() {
  for (libusb_transfer* const transfer : reads_) {
    libusb_cancel_transfer(transfer);
  }
  libusb_cancel_transfer(write_);
  for (int i = 0; i < 100 && pending_ > 0; ++i) {
    timeval patience{.tv_sec = 0, .tv_usec = 10'000};
    libusb_handle_events_timeout_completed(context_, &patience, nullptr);
  }
}

void UsbSerial::on_read(libusb_transfer& transfer) {
  --pending_;
  if (transfer.status != LIBUSB_TRANSFER_COMPLETED) {
    gone_ = true;
    return;
  }
  if (transfer.actual_length > 0) {
    const auto size_bytes = static_cast<std::size_t>(transfer.actual_length);
    static_cast<void>(::send(pump_.get(), transfer.buffer, size_bytes, MSG_NOSIGNAL));
  }
  const bool again = !gone_ && libusb_submit_transfer(&transfer) == 0;
  pending_ += again ? 1 : 0;
  gone_ = !again;
}

void UsbSerial::on_written(const libusb_transfer& transfer) {
  --pending_;
  writing_ = false;
  gone_ = gone_ || transfer.status != LIBUSB_TRANSFER_COMPLETED;
}

}  // namespace odoless
