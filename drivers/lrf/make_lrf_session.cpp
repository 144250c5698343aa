#include "drivers/lrf/make_lrf_session.hpp"

#include "drivers/lrf/scip/scip_session.hpp"
#include "drivers/lrf/sick/sick_session.hpp"

namespace odoless {

std::unique_ptr<LrfSession> make_lrf_session(const LrfParams& params, int beams_max) {
  ODOLESS_CHECK(parameters_in_range(params));
  switch (params.driver) {
    case LrfDriver::kScip:
      return std::make_unique<ScipSession>(params, beams_max);
    case LrfDriver::kSick:
      return std::make_unique<SickSession>(params, beams_max);
    case LrfDriver::kRplidar:
    case LrfDriver::kLcm:
      break;
  }
  ODOLESS_CHECK(false);
  return nullptr;
}

Result<FileDescriptor> open_lrf_line(const LrfParams& params) {
  return open_serial({.path = params.device, .baud = params.baud});
}

}  // namespace odoless
