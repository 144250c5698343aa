// Whatever lines of text come, at whatever times: the session neither crashes nor spins, and what it passes on is
// whole.
#include <cstddef>

#include "tests/fuzz/lrf_session_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::LrfParams params;
  params.driver = odoless::LrfDriver::kCsv;
  odoless::test::fuzz_session("csv", params, {reinterpret_cast<const char*>(data), size});
  return 0;
}
