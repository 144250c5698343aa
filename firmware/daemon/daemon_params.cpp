#include "firmware/daemon/daemon_params.hpp"

#include <fmt/format.h>

#include "drivers/lrf/sick/scan_stream.hpp"

namespace odoless {

// How many beams a Hokuyo has, it says itself.
std::string DaemonParams::contradiction() const {
  const int beams_max = robot.scan.beams_max;
  if (lrf.driver == LrfDriver::kRplidar && lrf.rplidar_beams > beams_max) {
    return fmt::format("lrf.rplidar_beams = {} is more than scan.beams_max = {}: make one smaller or the other larger",
                       lrf.rplidar_beams, beams_max);
  }
  if (const int beams = sick::variant_of(lrf.sick_variant).beams();
      lrf.driver == LrfDriver::kSick && beams > beams_max) {
    return fmt::format("lrf.sick_variant has {} beams, more than scan.beams_max = {}, which must be larger", beams,
                       beams_max);
  }
  return "";
}

}  // namespace odoless
