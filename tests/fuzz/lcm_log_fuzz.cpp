// Whatever a file holds that begins as an LCM log, reading it ends with a consistent log or a DataError.
#include "tests/fuzz/message_log_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return odoless::test::fuzz_log("LCM log", data, size);
}
