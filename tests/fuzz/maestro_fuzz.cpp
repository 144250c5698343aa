// Whatever bytes a Maestro's line carries, at whatever times: the session neither crashes nor spins, and what it
// passes on is in order. Each piece of the input: how many milliseconds pass, how many bytes follow, what the session
// is told and hears from then on; and the bytes.
#include <algorithm>

#include "tests/fuzz/servo_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::FuzzedServo servo(odoless::TiltDriver::kMaestro);
  std::size_t pieces = 0;
  for (std::size_t at = 0; at + 3 <= size && pieces < 200; ++pieces) {
    const std::size_t count = std::min<std::size_t>(data[at + 1], size - at - 3);
    servo.pass((1 + data[at] % 64) * odoless::test::kServoMs);
    servo.give({data + at + 3, count}, data[at + 2] % 8 != 0);
    servo.command(data[at + 2] / 8U);
    at += 3 + count;
  }
  for (int i = 0; i < 5; ++i) {
    servo.pass(10 * odoless::test::kServoMs);
  }
  return 0;
}
