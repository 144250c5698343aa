#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/io/file_descriptor.hpp"
#include "tools/emulate/device_loop.hpp"
#include "tools/emulate/emulated_line.hpp"
#include "tools/emulate/emulated_servo.hpp"
#include "tools/log/candump.hpp"

namespace odoless {

/// What an emulated servo, or a recorded device of any kind, is connected to.
class ServoLine {
 public:
  ServoLine() = default;
  ServoLine(const ServoLine&) = delete;
  ServoLine& operator=(const ServoLine&) = delete;
  virtual ~ServoLine() = default;

  /// To be waited for; -1: nobody is there.
  [[nodiscard]] virtual int descriptor() = 0;
  /// The rate that the client has set; 0: none of the standard ones, or the line has no rate.
  [[nodiscard]] virtual int baud() { return 0; }
  /// What has come, in order.
  [[nodiscard]] virtual std::vector<ServoFrame> read() = 0;
  /// Writes at once what the line takes; a CAN bus that is full drops it, another line takes the rest later.
  virtual void write(const ServoFrame& frame) = 0;
  /// Whether something is still to be written, by the next `read` or `write`.
  [[nodiscard]] virtual bool has_waiting() const { return false; }
};

/// A line of bytes, without frames.
[[nodiscard]] std::unique_ptr<ServoLine> make_servo_stream(std::unique_ptr<EmulatedLine> line);

/// @param log  File for all frames, in candump's format; empty: none.
/// @throws CannotCreateError; NoInputError: no such CAN interface, or it cannot be used.
[[nodiscard]] std::unique_ptr<ServoLine> make_servo_can(const std::string& interface, const std::filesystem::path& log);

/// What a loop waits for on behalf of a line.
[[nodiscard]] pollfd waits_for(ServoLine& line);

/// An emulated servo on its line; both must outlive it.
class LoopedServo final : public LoopedDevice {
 public:
  LoopedServo(EmulatedServo& servo, ServoLine& line) : servo_(servo), line_(line) {}

  void step(std::int64_t now_ns) override;
  [[nodiscard]] pollfd waits_for() override { return odoless::waits_for(line_); }
  [[nodiscard]] std::int64_t next_event_ns() const override { return servo_.next_event_ns(); }

 private:
  EmulatedServo& servo_;
  ServoLine& line_;
};

}  // namespace odoless
