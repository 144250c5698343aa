// Whatever a file holds that begins as a ROS 1 bag, reading it ends with a consistent log or a DataError.
#include "tests/fuzz/message_log_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return odoless::test::fuzz_log("ROS 1 bag", data, size);
}
