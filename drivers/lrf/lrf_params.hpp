#pragma once

#include <cstdint>
#include <string>

#include "core/base/parameters.hpp"

namespace odoless {

/// Which protocol the laser speaks.
enum class LrfDriver : std::uint8_t {
  kScip,  ///< Hokuyo SCIP 2.0 on a serial line
  kLcm,   ///< no device: scans come over LCM
};
inline constexpr const char* kLrfDriverNames[] = {"scip", "lcm"};

/// What a laser is asked for.
enum class LrfReading : std::uint8_t {
  kRange,           ///< SCIP: MD, 3 characters per range
  kShortRange,      ///< SCIP: MS, 2 characters, ranges up to 4 m: for slow lines
  kRangeIntensity,  ///< SCIP: ME; the intensities are dropped
};
inline constexpr const char* kLrfReadingNames[] = {"range", "short_range", "range_intensity"};

struct LrfParams {
  LrfDriver driver = LrfDriver::kScip;
  std::string device = "/dev/ttyACM0";
  std::string channel = "LASER";
  int baud = 0;
  LrfReading reading = LrfReading::kRange;
  int cluster = 1;
  int skip = 0;
  std::int64_t reply_timeout_ns = 200'000'000;
  std::int64_t stall_timeout_ns = 500'000'000;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("driver", self.driver, kLrfDriverNames,
                 "Protocol of the laser range finder; lcm: another program reads it, and scans come over LCM.");
    visit.text("device", self.device,
               "Where the laser is: a path, tcp://ADDRESS:PORT (numbers, no name), or usb://VENDOR:PRODUCT[/SERIAL].");
    visit.text("channel", self.channel, "Channel of the scans (planar_lidar_t) for the driver lcm.");
    visit.value("baud", self.baud, Range{0, 4'000'000}, "Rate of a serial line; 0 for USB, which has none.");
    visit.choice("reading", self.reading, kLrfReadingNames, "What the laser sends of each beam.");
    visit.value("cluster", self.cluster, Range{1, 99}, "Neighbouring beams that the laser joins to one, the nearest.");
    visit.value("skip", self.skip, Range{0, 9}, "Scans that the laser leaves out after each one that it sends.");
    visit.value("reply_timeout_ns", self.reply_timeout_ns, Range<std::int64_t>{10'000'000, 10'000'000'000},
                "Time for an answer while the laser is brought up.");
    visit.value("stall_timeout_ns", self.stall_timeout_ns, Range<std::int64_t>{50'000'000, 60'000'000'000},
                "Time without a good scan after which the laser is brought up anew.");
  }
};

}  // namespace odoless
