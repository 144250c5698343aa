#include "drivers/lrf/make_lrf_session.hpp"

#include <sys/ioctl.h>

#include "drivers/io/device_address.hpp"
#include "drivers/lrf/csv/csv_session.hpp"
#include "drivers/lrf/ldrobot/ldrobot_session.hpp"
#include "drivers/lrf/rplidar/rplidar_session.hpp"
#include "drivers/lrf/scip/scip_session.hpp"
#include "drivers/lrf/sick/sick_session.hpp"
#include "drivers/lrf/sopas/sopas_session.hpp"
#include "drivers/lrf/ydlidar/ydlidar_session.hpp"

namespace odoless {

std::unique_ptr<LrfSession> make_lrf_session(const LrfParams& params, int beams_max) {
  ODOLESS_CHECK(parameters_in_range(params));
  switch (params.driver) {
    case LrfDriver::kScip: {
      LrfParams fitting = params;
      fitting.baud = is_serial(params.device) ? params.baud : 0;  // USB and networks are Hokuyo's own: without a rate
      return std::make_unique<ScipSession>(fitting, beams_max);
    }
    case LrfDriver::kSick:
      return std::make_unique<SickSession>(params, beams_max);
    case LrfDriver::kRplidar:
      return std::make_unique<RplidarSession>(params, beams_max);
    case LrfDriver::kLdrobot:
      return std::make_unique<LdrobotSession>(params, beams_max);
    case LrfDriver::kYdlidar:
      return std::make_unique<YdlidarSession>(params, beams_max);
    case LrfDriver::kSopas:
      return std::make_unique<SopasSession>(params, beams_max);
    case LrfDriver::kCsv:
      return std::make_unique<CsvSession>(params, beams_max);
    case LrfDriver::kLcm:
      break;
  }
  ODOLESS_CHECK(false);
  return nullptr;
}

void set_up_lrf_line(const LrfParams& params, int descriptor) {
  if (params.driver == LrfDriver::kRplidar) {
    // The A1's motor turns while this signal is off, and opening the line has put it on. Lines without it don't mind.
    const int data_terminal_ready = TIOCM_DTR;
    static_cast<void>(::ioctl(descriptor, TIOCMBIC, &data_terminal_ready));
  }
}

}  // namespace odoless
