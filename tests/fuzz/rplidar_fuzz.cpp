// Whatever an RPLIDAR's line carries, at whatever times: the session neither crashes nor spins, and what it passes on
// is whole. The input's first byte says which laser it is and which of its scans is asked for, so that each kind of
// packets comes.
#include <array>
#include <cstddef>

#include "tests/fuzz/lrf_session_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  struct Asked {
    const char* model;
    odoless::RplidarScan scan;
  };
  constexpr std::array<Asked, 5> kAsked{{{"rplidar-a2", odoless::RplidarScan::kStandard},
                                         {"rplidar-a2", odoless::RplidarScan::kExpress},
                                         {"rplidar-a3", odoless::RplidarScan::kUsual},
                                         {"rplidar-s2", odoless::RplidarScan::kUsual},
                                         {"rplidar-s3", odoless::RplidarScan::kUsual}}};
  odoless::LrfParams params;
  params.driver = odoless::LrfDriver::kRplidar;
  params.rplidar_beams = 180;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  const Asked& asked = kAsked[rest.empty() ? 0 : static_cast<unsigned char>(rest.front()) % kAsked.size()];
  params.rplidar_scan = asked.scan;
  rest.remove_prefix(rest.empty() ? 0 : 1);
  odoless::test::fuzz_session(asked.model, params, rest);
  return 0;
}
