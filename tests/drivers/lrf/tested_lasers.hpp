#pragma once

#include <ostream>
#include <string>

#include "drivers/lrf/lrf_params.hpp"

namespace odoless::test {

/// An emulated laser and how it is asked, for what holds of every driver.
struct TestedLaser {
  const char* name;   ///< of the test
  const char* model;  ///< of the emulator
  LrfDriver driver;
  int baud = 0;  ///< 0: as it comes, or searched for
  int wrong_baud =
      0;  ///< a rate that the driver keeps to though the laser has another; 0: the driver finds the right one
  LrfReading reading = LrfReading::kRange;
  RplidarScan rplidar_scan = RplidarScan::kUsual;
  SickVariant sick_variant = SickVariant::k180ByHalf;
  LrfRanging ydlidar_ranging = LrfRanging::kTriangle;
  SopasScan sopas_scan = SopasScan::kAsSet;
  int skip = 0;
  double sees_to_m = 8.0;  ///< what it is to see has to be nearer
  bool has_sums = true;    ///< its protocol: what is damaged can be told

  [[nodiscard]] LrfParams params() const {
    LrfParams params;
    params.driver = driver;
    params.baud = baud;
    params.reading = reading;
    params.rplidar_scan = rplidar_scan;
    params.sick_variant = sick_variant;
    params.ydlidar_ranging = ydlidar_ranging;
    params.sopas_scan = sopas_scan;
    params.skip = skip;
    return params;
  }
  friend void PrintTo(const TestedLaser& laser, std::ostream* out) { *out << laser.name; }
};

/// One at least of each driver, and of each stream of it.
inline constexpr TestedLaser kTestedLasers[] = {
    {.name = "scip_urg", .model = "urg-04lx", .driver = LrfDriver::kScip},
    {.name = "scip_utm", .model = "utm-30lx", .driver = LrfDriver::kScip},
    {.name = "scip_last_echo", .model = "utm-30lx-ew", .driver = LrfDriver::kScip, .reading = LrfReading::kLastEcho},
    {.name = "scip_strongest_echo",
     .model = "utm-30lx-ew",
     .driver = LrfDriver::kScip,
     .reading = LrfReading::kStrongestEcho},
    {.name = "sick", .model = "lms200", .driver = LrfDriver::kSick, .baud = 38400},
    {.name = "sick_degree",
     .model = "lms200",
     .driver = LrfDriver::kSick,
     .baud = 38400,
     .sick_variant = SickVariant::k180By1},
    {.name = "sick_quick", .model = "lms291", .driver = LrfDriver::kSick, .baud = 500000},
    {.name = "rplidar_standard",
     .model = "rplidar-a1",
     .driver = LrfDriver::kRplidar,
     .wrong_baud = 256000,
     .rplidar_scan = RplidarScan::kStandard,
     .has_sums = false},
    {.name = "rplidar_express",
     .model = "rplidar-a2",
     .driver = LrfDriver::kRplidar,
     .wrong_baud = 256000,
     .rplidar_scan = RplidarScan::kExpress},
    {.name = "rplidar_a1", .model = "rplidar-a1", .driver = LrfDriver::kRplidar, .wrong_baud = 256000},
    {.name = "rplidar_a2", .model = "rplidar-a2", .driver = LrfDriver::kRplidar, .wrong_baud = 256000},
    {.name = "rplidar_a3", .model = "rplidar-a3", .driver = LrfDriver::kRplidar, .wrong_baud = 115200},
    {.name = "rplidar_c1", .model = "rplidar-c1", .driver = LrfDriver::kRplidar, .wrong_baud = 256000},
    {.name = "rplidar_s1", .model = "rplidar-s1", .driver = LrfDriver::kRplidar, .wrong_baud = 1000000},
    {.name = "rplidar_s2", .model = "rplidar-s2", .driver = LrfDriver::kRplidar, .wrong_baud = 460800},
    {.name = "rplidar_s3", .model = "rplidar-s3", .driver = LrfDriver::kRplidar, .wrong_baud = 256000},
    {.name = "ldrobot_ld06", .model = "ld06", .driver = LrfDriver::kLdrobot, .wrong_baud = 921600},
    {.name = "ldrobot_ld19", .model = "ld19", .driver = LrfDriver::kLdrobot, .wrong_baud = 115200},
    {.name = "ldrobot_stl", .model = "stl-27l", .driver = LrfDriver::kLdrobot, .wrong_baud = 230400},
    {.name = "ydlidar_x2", .model = "ydlidar-x2", .driver = LrfDriver::kYdlidar, .wrong_baud = 128000},
    {.name = "ydlidar_x4", .model = "ydlidar-x4", .driver = LrfDriver::kYdlidar, .wrong_baud = 115200},
    {.name = "ydlidar_g4", .model = "ydlidar-g4", .driver = LrfDriver::kYdlidar, .wrong_baud = 512000},
    {.name = "ydlidar_tg30",
     .model = "ydlidar-tg30",
     .driver = LrfDriver::kYdlidar,
     .wrong_baud = 230400,
     .ydlidar_ranging = LrfRanging::kTimeOfFlight},
    {.name = "sopas_ascii", .model = "lms111", .driver = LrfDriver::kSopas, .has_sums = false},
    {.name = "sopas_quarter",
     .model = "lms111",
     .driver = LrfDriver::kSopas,
     .sopas_scan = SopasScan::k25HzByQuarter,
     .has_sums = false},
    {.name = "sopas_tim551", .model = "tim551", .driver = LrfDriver::kSopas, .has_sums = false},
    {.name = "sopas_binary", .model = "tim571", .driver = LrfDriver::kSopas},
    {.name = "sopas_lms4xxx", .model = "lms4124", .driver = LrfDriver::kSopas, .skip = 9, .sees_to_m = 3.0},
    {.name = "csv", .model = "csv", .driver = LrfDriver::kCsv, .has_sums = false},
};

inline std::string laser_name(const auto& tested) { return tested.param.name; }

}  // namespace odoless::test
