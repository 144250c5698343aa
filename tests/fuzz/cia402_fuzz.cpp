// Whatever frames a CAN bus carries, at whatever times: the session neither crashes nor spins, and what it passes on is
// in order. Each 18 bytes of the input are one frame, put between those of an emulated drive: how many milliseconds
// pass before it, its bytes, and what the session is told and hears from then on.
#include "tests/fuzz/servo_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kPieceBytes = 18;
  constexpr std::size_t kPiecesMax = 200;
  odoless::test::FuzzedServo servo(odoless::TiltDriver::kCia402);
  for (std::size_t at = 0; at + kPieceBytes <= size && at < kPiecesMax * kPieceBytes; at += kPieceBytes) {
    servo.pass((1 + data[at] % 32) * odoless::test::kServoMs);
    servo.give({data + at + 1, 16}, data[at + 17] % 8 != 0);
    servo.command(data[at + 17] / 8U);
  }
  for (int i = 0; i < 5; ++i) {
    servo.pass(10 * odoless::test::kServoMs);
  }
  return 0;
}
