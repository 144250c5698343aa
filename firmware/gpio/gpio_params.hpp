#pragma once

#include <cstdint>
#include <string>

#include "core/base/parameters.hpp"

namespace odoless {

enum class PinLevel : std::uint8_t { kLow, kHigh };
inline constexpr const char* kPinLevelNames[] = {"low", "high"};

enum class PinEdge : std::uint8_t { kRising, kFalling };
inline constexpr const char* kPinEdgeNames[] = {"rising", "falling"};

/// What is wired to the machine's GPIO lines. A line is named CHIP:OFFSET ("gpiochip0:17"), or by its own name; empty:
/// it isn't there. The daemon that reads the laser serves them, and no other: it alone knows whether scans come, it
/// moves the servo, and a line can be had once, also where two halves share a machine and a file.
struct GpioParams {
  std::string stop_line;
  PinLevel stop_level = PinLevel::kLow;
  std::string sync_line;
  PinEdge sync_edge = PinEdge::kRising;
  std::int64_t sync_delay_ns = 0;
  std::string power_line;
  PinLevel power_level = PinLevel::kHigh;
  std::int64_t power_cycle_after_ns = 10'000'000'000;
  std::int64_t power_off_ns = 1'000'000'000;
  std::string led_line;
  PinLevel led_level = PinLevel::kHigh;
  int priority = 70;

  [[nodiscard]] bool is_used() const {
    return !stop_line.empty() || !sync_line.empty() || !power_line.empty() || !led_line.empty();
  }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("stop_line", self.stop_line,
               "Input of the emergency stop: CHIP:OFFSET or a line's name; empty: none. [gpio] is served by the "
               "daemon that reads the laser itself: not with lrf.driver = \"lcm\", nor by the filter's half.");
    visit.choice("stop_level", self.stop_level, kPinLevelNames,
                 "Level that means stop; the line is pulled there, so that a broken wire is a stop.");
    visit.text("sync_line", self.sync_line, "Input of the laser's pulse, one per turn of its mirror; empty: none.");
    visit.choice("sync_edge", self.sync_edge, kPinEdgeNames, "Edge of the pulse that counts.");
    visit.value("sync_delay_ns", self.sync_delay_ns, Range<std::int64_t>{-100'000'000, 100'000'000},
                "Time from that edge to the first beam of the scan.");
    visit.text("power_line", self.power_line, "Output that switches the laser's power; empty: none.");
    visit.choice("power_level", self.power_level, kPinLevelNames, "Level at which the laser has power.");
    visit.value("power_cycle_after_ns", self.power_cycle_after_ns, Range<std::int64_t>{1'000'000'000, 600'000'000'000},
                "Time without a scan after which the laser is switched off and on again.");
    visit.value("power_off_ns", self.power_off_ns, Range<std::int64_t>{10'000'000, 60'000'000'000},
                "Time for which the power stays off.");
    visit.text("led_line", self.led_line, "Output of the status light; empty: none.");
    visit.choice("led_level", self.led_level, kPinLevelNames, "Level at which the light is on.");
    visit.value("priority", self.priority, Range{0, 98},
                "Priority (SCHED_FIFO) of the thread that serves these lines; 0: an ordinary thread. A delay of 60 ms "
                "counts as an emergency stop where there is a stop_line.");
  }
};

}  // namespace odoless
