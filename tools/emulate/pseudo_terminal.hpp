#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/io/file_descriptor.hpp"

namespace odoless {

/// The device's side of a serial line that isn't there: a pseudo-terminal, raw, with a link to the client's side.
/// Clients may come and go. The link is removed in the end.
class PseudoTerminal {
 public:
  /// @throws CannotCreateError when there is something else than a link at `link`, or it cannot be made.
  explicit PseudoTerminal(std::filesystem::path link);
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;
  ~PseudoTerminal();

  [[nodiscard]] int descriptor() const { return device_.get(); }
  /// Of the client's side.
  [[nodiscard]] const std::string& path() const { return path_; }

  /// Whether a client has the line open.
  [[nodiscard]] bool has_client() const;

  /// The rate that the client has set; 0: none of the standard ones.
  [[nodiscard]] int baud() const;

  /// What the client has sent; empty: nothing.
  [[nodiscard]] std::string read() const;

  /// Writes what the line takes at once and returns how many bytes that is.
  [[nodiscard]] std::size_t write(std::string_view bytes) const;

 private:
  FileDescriptor device_;
  std::string path_;
  std::filesystem::path link_;
};

}  // namespace odoless
