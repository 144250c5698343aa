#include "drivers/lrf/make_lrf_session.hpp"

#include "drivers/io/device_address.hpp"
#include "drivers/lrf/scip/scip_session.hpp"

namespace odoless {

std::unique_ptr<LrfSession> make_lrf_session(const LrfParams& params, int beams_max) {
  ODOLESS_CHECK(parameters_in_range(params));
  LrfParams fitting = params;
  if (const auto address = parse_device_address(params.device);
      address.ok() && !std::holds_alternative<SerialAddress>(address.value())) {
    fitting.baud = 0;  // the line has no rate, so the device isn't to be told one
  }
  switch (fitting.driver) {
    case LrfDriver::kScip:
      return std::make_unique<ScipSession>(fitting, beams_max);
    case LrfDriver::kLcm:
      break;
  }
  ODOLESS_CHECK(false);
  return nullptr;
}

}  // namespace odoless
