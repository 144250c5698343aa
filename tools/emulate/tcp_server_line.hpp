#pragma once

#include <cstdint>

#include "drivers/io/file_descriptor.hpp"
#include "tools/emulate/emulated_line.hpp"

namespace odoless {

/// A device on a network: listens on the loopback interface and serves one client at a time; the next one waits.
class TcpServerLine final : public EmulatedLine {
 public:
  /// @param port  0: any that is free. @throws CannotCreateError
  explicit TcpServerLine(std::uint16_t port);

  [[nodiscard]] int descriptor() const override { return client_.get(); }
  [[nodiscard]] int idle_descriptor() const override { return listener_.get(); }
  [[nodiscard]] std::string path() const override;
  [[nodiscard]] bool has_client() override;
  [[nodiscard]] std::string read() override;
  [[nodiscard]] std::size_t write(std::string_view bytes) override;

 private:
  FileDescriptor listener_;
  FileDescriptor client_;
  std::uint16_t port_ = 0;
};

}  // namespace odoless
