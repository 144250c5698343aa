#include "firmware/daemon/daemon_params.hpp"

#include <fmt/format.h>

#include "drivers/lrf/sick/scan_stream.hpp"

namespace odoless {

// How many beams a Hokuyo has, it says itself.
std::string DaemonParams::contradiction() const {
  const int beams_max = robot.scan.beams_max;
  const auto too_many = [&](LrfDriver driver, const char* key, int beams) {
    return lrf.driver != driver || beams <= beams_max
               ? std::string()
               : fmt::format("lrf.{} = {} is more than scan.beams_max = {}: make one smaller or the other larger", key,
                             beams, beams_max);
  };
  for (const std::string& said : {too_many(LrfDriver::kRplidar, "rplidar_beams", lrf.rplidar_beams),
                                  too_many(LrfDriver::kLdrobot, "ldrobot_beams", lrf.ldrobot_beams),
                                  too_many(LrfDriver::kYdlidar, "ydlidar_beams", lrf.ydlidar_beams)}) {
    if (!said.empty()) {
      return said;
    }
  }
  if (const int beams = sick::variant_of(lrf.sick_variant).beams();
      lrf.driver == LrfDriver::kSick && beams > beams_max) {
    return fmt::format("lrf.sick_variant has {} beams, more than scan.beams_max = {}, which must be larger", beams,
                       beams_max);
  }
  if (world.mode == WorldUse::kLocalise && world.file.empty()) {
    return "world.mode is \"localise\", and world.file names no world to find the way in";
  }
  if (!world.file.empty() && !robot.graph.enabled) {
    return "world.file keeps the pose graph, and graph.enabled is false: leave one out";
  }
  return web.contradiction();
}

}  // namespace odoless
