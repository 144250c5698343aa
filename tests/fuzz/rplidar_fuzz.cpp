// Whatever an RPLIDAR's line carries, at whatever times: the session neither crashes nor spins, and what it passes on
// is whole. The input's first byte says which of the two scans is asked for.
#include <cstddef>

#include "tests/fuzz/lrf_session_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::LrfParams params;
  params.driver = odoless::LrfDriver::kRplidar;
  params.rplidar_beams = 180;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  if (!rest.empty()) {
    params.rplidar_scan = rest.front() % 2 == 0 ? odoless::RplidarScan::kStandard : odoless::RplidarScan::kExpress;
    rest.remove_prefix(1);
  }
  odoless::test::fuzz_session("rplidar-a2", params, rest);
  return 0;
}
