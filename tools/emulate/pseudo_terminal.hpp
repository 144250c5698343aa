#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/io/file_descriptor.hpp"
#include "tools/emulate/emulated_line.hpp"

namespace odoless {

/// The device's side of a serial line that isn't there: a pseudo-terminal, raw, with a link to the client's side.
/// Clients may come and go. The link is removed in the end.
class PseudoTerminal final : public EmulatedLine {
 public:
  /// @throws CannotCreateError when there is something else than a link at `link`, or it cannot be made.
  explicit PseudoTerminal(std::filesystem::path link);
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;
  ~PseudoTerminal() override;

  [[nodiscard]] int descriptor() const override { return device_.get(); }
  [[nodiscard]] std::string path() const override { return path_; }
  [[nodiscard]] bool has_client() override;
  [[nodiscard]] int baud() override;
  [[nodiscard]] std::string read() override;
  [[nodiscard]] std::size_t write(std::string_view bytes) override;

 private:
  FileDescriptor device_;
  std::string path_;
  std::filesystem::path link_;
};

}  // namespace odoless
