#pragma once

#include <cstdint>
#include <string>

#include "core/base/parameters.hpp"

namespace odoless {

/// Which protocol the laser speaks.
enum class LrfDriver : std::uint8_t {
  kScip,     ///< Hokuyo SCIP 2.0 on a serial line
  kLcm,      ///< no device: scans come over LCM
  kSick,     ///< telegrams of the SICK LMS2xx on a serial line
  kRplidar,  ///< Slamtec RPLIDAR, A, C and S series, on a serial line
  kLdrobot,  ///< LDROBOT LD06, LD19, STL-27L, on a serial line
  kYdlidar,  ///< YDLIDAR X2, X4, G4, TG and their kin, on a serial line
  kSopas,    ///< SICK TiM5xx, LMS1xx, LMS4xxx and their kin, by SOPAS over TCP
  kCsv,      ///< lasers of one's own: lines of text over UDP, TCP or a serial line
};
inline constexpr const char* kLrfDriverNames[] = {"scip",    "lcm",     "sick",  "rplidar",
                                                  "ldrobot", "ydlidar", "sopas", "csv"};

/// What a laser is asked for.
enum class LrfReading : std::uint8_t {
  kRange,           ///< SCIP: MD, 3 characters per range
  kShortRange,      ///< SCIP: MS, 2 characters, ranges up to 4 m: for slow lines
  kRangeIntensity,  ///< SCIP: ME; the intensities are dropped
  kLastEcho,        ///< SCIP: ND; of lasers that tell several echoes of a beam, the farthest
  kStrongestEcho,   ///< SCIP: NE; of these, the one of the highest intensity
};
inline constexpr const char* kLrfReadingNames[] = {"range", "short_range", "range_intensity", "last_echo",
                                                   "strongest_echo"};

/// Field of view and step of a SICK LMS2xx, in degrees.
enum class SickVariant : std::uint8_t { k180By1, k180ByHalf, k100By1, k100ByHalf, k100ByQuarter };
inline constexpr const char* kSickVariantNames[] = {"180/1", "180/0.5", "100/1", "100/0.5", "100/0.25"};

/// What a SICK LMS2xx counts ranges in.
enum class SickUnit : std::uint8_t {
  kMm,  ///< up to 32 m
  kCm,  ///< up to 80 m
};
inline constexpr const char* kSickUnitNames[] = {"mm", "cm"};

/// What an RPLIDAR is asked for.
enum class RplidarScan : std::uint8_t {
  kUsual,     ///< the mode that the device itself recommends; of old ones, the best that they know
  kStandard,  ///< every model knows it: an A1 gives 2000 points a second, without a check sum
  kExpress,   ///< an A1 gives 4000, with check sums; firmware 1.17 and later
};
inline constexpr const char* kRplidarScanNames[] = {"usual", "standard", "express"};

/// How a YDLIDAR measures, which its packets do not tell.
enum class LrfRanging : std::uint8_t {
  kTriangle,      ///< X2, X4, G4 and most others: quarters of a mm
  kTimeOfFlight,  ///< TG15, TG30, TG50, TX8, TX20: mm
};
inline constexpr const char* kLrfRangingNames[] = {"triangle", "time_of_flight"};

/// What a SICK laser that speaks SOPAS is set to.
enum class SopasScan : std::uint8_t {
  kAsSet,          ///< as it is; TiM5xx have one rate and step
  k25HzByQuarter,  ///< LMS1xx
  k50HzByHalf,     ///< LMS1xx
};
inline constexpr const char* kSopasScanNames[] = {"as_set", "25/0.25", "50/0.5"};

struct LrfParams {
  LrfDriver driver = LrfDriver::kScip;
  std::string device = "/dev/ttyACM0";
  std::string channel = "LASER";
  int baud = 0;
  LrfReading reading = LrfReading::kRange;
  int cluster = 1;
  int skip = 0;
  bool deskew = true;
  SickVariant sick_variant = SickVariant::k180ByHalf;
  SickUnit sick_unit = SickUnit::kMm;
  RplidarScan rplidar_scan = RplidarScan::kUsual;
  int rplidar_beams = 360;
  int rplidar_pwm = 0;
  int ldrobot_beams = 450;
  int ydlidar_beams = 450;
  LrfRanging ydlidar_ranging = LrfRanging::kTriangle;
  SopasScan sopas_scan = SopasScan::kAsSet;
  std::int64_t reply_timeout_ns = 200'000'000;
  std::int64_t stall_timeout_ns = 500'000'000;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("driver", self.driver, kLrfDriverNames,
                 "Protocol of the laser range finder; lcm: another program reads it, and scans come over LCM.");
    visit.text("device", self.device,
               "Where the laser is: a path, tcp://HOST:PORT, usb://VENDOR:PRODUCT[/SERIAL], or udp://HOST:PORT "
               "to listen at.");
    visit.text("channel", self.channel, "Channel of the scans (planar_lidar_t) for the driver lcm.");
    visit.value(
        "baud", self.baud, Range{0, 4'000'000},
        "Rate of the serial line, which Hokuyo and SICK lasers are switched to; 0: the one that the laser has "
        "(USB has none). Of a SICK, RPLIDAR, LDROBOT or YDLIDAR on tcp:// or usb://: what the far end's line has, for "
        "the stamps.");
    visit.choice(
        "reading", self.reading, kLrfReadingNames,
        "What a Hokuyo sends for each beam. Of a multi-echo laser (UTM-30LX-EW), range is the first echo: behind "
        "rain, dust and glass, last_echo or strongest_echo sees the wall.");
    visit.value("cluster", self.cluster, Range{1, 99}, "Neighbouring beams that the laser joins to one, the nearest.");
    visit.value("skip", self.skip, Range{0, 9},
                "Scans that a Hokuyo, or a SICK by SOPAS, leaves out after each one that it sends.");
    visit.flag(
        "deskew", self.deskew,
        "Whether the motion during a scan is taken out of it, where the laser tells when each beam was measured.");
    visit.choice("sick_variant", self.sick_variant, kSickVariantNames,
                 "Field of view and step of a SICK laser, in degrees.");
    visit.choice("sick_unit", self.sick_unit, kSickUnitNames,
                 "Unit of a SICK laser's ranges: mm up to 32 m, or cm up to 80 m.");
    visit.choice(
        "rplidar_scan", self.rplidar_scan, kRplidarScanNames,
        "How an RPLIDAR scans: in the mode that it recommends itself (usual), in the one that every model knows "
        "(standard: the fewest points, no check sums), or in the next one (express).");
    visit.value(
        "rplidar_beams", self.rplidar_beams, Range{90, 3600},
        "Evenly spaced beams that a turn of an RPLIDAR is given as; in its usual mode at 10 Hz it has 500 points "
        "(C1), 800 (A1, A2), 920 (S1), 1600 (A3) or 3200 (S2).");
    visit.value("rplidar_pwm", self.rplidar_pwm, Range{0, 1023},
                "Duty of an RPLIDAR's motor, for models that take it as a command (A2, A3); 0: what the model needs.");
    visit.value("ldrobot_beams", self.ldrobot_beams, Range{90, 3600},
                "Evenly spaced beams that a turn of an LDROBOT laser is given as; it has 450 points at 10 Hz (LD06, "
                "LD19), or 2160 (STL-27L).");
    visit.value("ydlidar_beams", self.ydlidar_beams, Range{90, 3600},
                "Evenly spaced beams that a turn of a YDLIDAR is given as; at 7 Hz it has 430 points (X2), 710 (X4), "
                "1290 (G4).");
    visit.choice(
        "ydlidar_ranging", self.ydlidar_ranging, kLrfRangingNames,
        "How a YDLIDAR measures ranges: triangle (X2, X4, G4 and most others), or time_of_flight (TG and TX).");
    visit.choice("sopas_scan", self.sopas_scan, kSopasScanNames,
                 "Rate in Hz and step in degrees that an LMS1xx is set to; as_set: those it has.");
    visit.value("reply_timeout_ns", self.reply_timeout_ns, Range<std::int64_t>{10'000'000, 10'000'000'000},
                "Longest time for an answer while the laser is started.");
    visit.value("stall_timeout_ns", self.stall_timeout_ns, Range<std::int64_t>{50'000'000, 60'000'000'000},
                "Time without a good scan after which the laser is restarted.");
  }
};

}  // namespace odoless
