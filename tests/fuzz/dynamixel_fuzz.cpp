// Whatever bytes a Dynamixel's line carries, at whatever times: the session neither crashes nor spins, and what it
// passes on is in order.
#include "tests/fuzz/servo_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::fuzz_stream(odoless::TiltDriver::kDynamixel, data, size);
  return 0;
}
