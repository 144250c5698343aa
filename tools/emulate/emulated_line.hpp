#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace odoless {

/// The device's side of a line that isn't there. Clients may come and go.
///
/// Thread: one.
class EmulatedLine {
 public:
  EmulatedLine() = default;
  EmulatedLine(const EmulatedLine&) = delete;
  EmulatedLine& operator=(const EmulatedLine&) = delete;
  virtual ~EmulatedLine() = default;

  /// To be waited for while there is a client.
  [[nodiscard]] virtual int descriptor() const = 0;
  /// To be waited for while there is none; -1: nothing tells, look again after a while.
  [[nodiscard]] virtual int idle_descriptor() const { return -1; }
  /// For a person: what a client opens.
  [[nodiscard]] virtual std::string path() const = 0;
  /// Whether a client has the line open; takes one that waits.
  [[nodiscard]] virtual bool has_client() = 0;
  /// The rate that the client has set; 0: none of the standard ones, or the line has no rate.
  [[nodiscard]] virtual int baud() { return 0; }
  /// What the client has sent; empty: nothing.
  [[nodiscard]] virtual std::string read() = 0;
  /// Writes what the line takes at once and returns how many bytes that is.
  [[nodiscard]] virtual std::size_t write(std::string_view bytes) = 0;
};

}  // namespace odoless
