#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/io/file_descriptor.hpp"
#include "tools/emulate/emulated_servo.hpp"
#include "tools/emulate/pseudo_terminal.hpp"
#include "tools/log/candump.hpp"

namespace odoless {

/// What an emulated servo is connected to.
class ServoLine {
 public:
  ServoLine() = default;
  ServoLine(const ServoLine&) = delete;
  ServoLine& operator=(const ServoLine&) = delete;
  virtual ~ServoLine() = default;

  /// To be waited for; -1: nobody is there.
  [[nodiscard]] virtual int descriptor() = 0;
  /// What has come, in order.
  [[nodiscard]] virtual std::vector<ServoFrame> read() = 0;
  /// Writes at once, or drops it.
  virtual void write(const ServoFrame& frame) = 0;
};

/// @throws CannotCreateError
[[nodiscard]] std::unique_ptr<ServoLine> make_servo_terminal(const std::filesystem::path& link);

/// @param log  File for all frames, in candump's format; empty: none.
/// @throws CannotCreateError; NoInputError: no such CAN interface, or it cannot be used.
[[nodiscard]] std::unique_ptr<ServoLine> make_servo_can(const std::string& interface, const std::filesystem::path& log);

/// Serves an emulated servo in real time until SIGTERM, SIGINT or the duration.
void emulate_servo(EmulatedServo& servo, ServoLine& line, std::int64_t duration_ns);

}  // namespace odoless
