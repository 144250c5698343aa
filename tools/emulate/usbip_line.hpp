#pragma once

#include "drivers/io/file_descriptor.hpp"
#include "tools/emulate/emulated_line.hpp"
#include "tools/emulate/usb_cdc_device.hpp"

namespace odoless {

/// A USB device plugged into this very machine: the kernel's virtual host controller (vhci_hcd) on one end of a socket,
/// a UsbCdcDevice on the other. It is pulled out in the end, also when the program is killed.
class UsbipLine final : public EmulatedLine {
 public:
  /// @throws CannotCreateError without vhci_hcd, without a free port of it, or without the right to (root).
  explicit UsbipLine(const UsbIdentity& identity);

  [[nodiscard]] int descriptor() const override { return kernel_.get(); }
  [[nodiscard]] int idle_descriptor() const override { return kernel_.get(); }
  [[nodiscard]] std::string path() const override { return path_; }
  [[nodiscard]] bool has_client() override;
  [[nodiscard]] std::string read() override;
  [[nodiscard]] std::size_t write(std::string_view bytes) override;

 private:
  void exchange();

  UsbCdcDevice device_;
  FileDescriptor kernel_;
  std::string path_;
  std::string unsent_;
};

}  // namespace odoless
