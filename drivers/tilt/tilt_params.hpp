#pragma once

#include <cstdint>
#include <string>

#include "core/base/parameters.hpp"

namespace odoless {

/// Which protocol the servo speaks that tilts the laser.
enum class TiltDriver : std::uint8_t {
  kNone,       ///< the laser is fixed
  kCia402,     ///< CANopen drive (CiA 301, 402) on SocketCAN
  kDynamixel,  ///< Dynamixel of the X or P series, Protocol 2.0, on a serial line
  kMaestro,    ///< RC servo at a Pololu Maestro, compact protocol, on a serial line or USB
};
inline constexpr const char* kTiltDriverNames[] = {"none", "cia402", "dynamixel", "maestro"};

/// What a servo is told to do.
enum class TiltCommand : std::uint8_t {
  kLevel,  ///< hold the laser's plane level, for 2D SLAM
  kSweep,  ///< nod between the two ends of the sweep
  kStop,   ///< stop as fast as it can, and stay so whatever happens
};
inline constexpr const char* kTiltCommandNames[] = {"level", "sweep", "stop"};

/// How a servo is left when the daemon ends.
enum class TiltEnd : std::uint8_t {
  kHold,     ///< stopped where it is, with torque
  kLevel,    ///< sent to the level pose, which it holds; what is left of the way it goes by itself
  kRelease,  ///< stopped and without torque
};
inline constexpr const char* kTiltEndNames[] = {"hold", "level", "release"};

/// Angles count from the level pose; positive tilts the laser down (REP-103: rotation about y).
struct TiltParams {
  TiltDriver driver = TiltDriver::kNone;
  std::string device = "can0";
  int id = 1;
  int baud = 57'600;
  TiltCommand at_start = TiltCommand::kLevel;
  TiltEnd at_end = TiltEnd::kHold;
  double level_angle_rad = 0.0;
  bool inverted = false;
  double limit_min_rad = -0.7853981633974483;
  double limit_max_rad = 0.7853981633974483;
  double sweep_from_rad = -0.5235987755982988;
  double sweep_to_rad = 0.5235987755982988;
  double speed_radps = 1.0471975511965976;
  double acceleration_radps2 = 10.471975511965978;
  double tolerance_rad = 0.008726646259971648;
  double level_tolerance_rad = 0.017453292519943295;
  std::int64_t sample_period_ns = 10'000'000;
  std::int64_t heartbeat_period_ns = 100'000'000;
  std::int64_t reply_timeout_ns = 50'000'000;
  std::int64_t stall_timeout_ns = 150'000'000;
  int master_id = 127;
  int counts_per_turn = 65'536;
  double speed_units_per_count = 1.0;
  bool cyclic_position = false;
  int homing_method = 0;
  double homing_speed_radps = 0.17453292519943295;
  std::int64_t homing_timeout_ns = 20'000'000'000;
  int channel = 0;
  double pulse_centre_us = 1500.0;
  double pulse_turn_us = 4000.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    constexpr double kHalfTurnRad = 3.1416;
    visit.choice("driver", self.driver, kTiltDriverNames, "Protocol of the servo that tilts the laser; none: fixed.");
    visit.text("device", self.device, "CAN interface (cia402) or path of the serial line (the others).");
    visit.value("id", self.id, Range{1, 127}, "Number of the servo on its bus.");
    visit.value("baud", self.baud, Range{0, 4'500'000},
                "Rate of the serial line; 0 for one without (dynamixel, maestro).");
    visit.choice("at_start", self.at_start, kTiltCommandNames, "What the servo does from the start on.");
    visit.choice("at_end", self.at_end, kTiltEndNames,
                 "How the servo is left when the daemon ends: stopped where it is, sent to the level pose, or without "
                 "torque (then the laser may sink). While the emergency stop is pressed, hold.");
    visit.value("level_angle_rad", self.level_angle_rad, Range{-kHalfTurnRad, kHalfTurnRad},
                "The servo's own angle at which the laser's plane is level; dynamixel, maestro: from its centre.");
    visit.flag("inverted", self.inverted, "Whether the servo's angle grows when the laser tilts up.");
    describe_motion(self, visit);
    describe_times(self, visit);
    describe_cia402(self, visit);
    describe_maestro(self, visit);
  }

 private:
  template <class Self, class Visitor>
  static void describe_motion(Self& self, Visitor& visit) {
    constexpr double kHalfTurnRad = 3.1416;
    visit.value("limit_min_rad", self.limit_min_rad, Range{-kHalfTurnRad, 0.0},
                "Lowest angle that the servo is sent to; angles count from the level pose, positive is down.");
    visit.value("limit_max_rad", self.limit_max_rad, Range{0.0, kHalfTurnRad},
                "Highest angle that the servo is sent to.");
    visit.value("sweep_from_rad", self.sweep_from_rad, Range{-kHalfTurnRad, kHalfTurnRad},
                "One end of the sweep; cut to the limits.");
    visit.value("sweep_to_rad", self.sweep_to_rad, Range{-kHalfTurnRad, kHalfTurnRad},
                "Other end of the sweep; cut to the limits.");
    visit.value("speed_radps", self.speed_radps, Range{0.01, 20.0}, "Speed of the servo.");
    visit.value("acceleration_radps2", self.acceleration_radps2, Range{0.1, 1000.0}, "Acceleration of the servo.");
    visit.value("tolerance_rad", self.tolerance_rad, Range{0.0005, 0.1},
                "Largest difference from a target angle at which it counts as reached.");
    visit.value("level_tolerance_rad", self.level_tolerance_rad, Range{0.001, 0.2},
                "How far from level the laser may be for 2D SLAM to take its scan.");
  }

  template <class Self, class Visitor>
  static void describe_times(Self& self, Visitor& visit) {
    visit.value("sample_period_ns", self.sample_period_ns, Range<std::int64_t>{2'000'000, 100'000'000},
                "Period of the angle measurements.");
    visit.value("heartbeat_period_ns", self.heartbeat_period_ns, Range<std::int64_t>{20'000'000, 2'000'000'000},
                "From one sign of life to the next; without one for three of these the servo counts as lost, and stops "
                "when it hears nothing of the daemon for as long.");
    visit.value("reply_timeout_ns", self.reply_timeout_ns, Range<std::int64_t>{5'000'000, 2'000'000'000},
                "Longest time for an answer of the servo.");
    visit.value("stall_timeout_ns", self.stall_timeout_ns, Range<std::int64_t>{30'000'000, 10'000'000'000},
                "Time without movement, where there should be some, after which the servo is stopped; a low speed or "
                "acceleration makes it longer.");
  }

  template <class Self, class Visitor>
  static void describe_cia402(Self& self, Visitor& visit) {
    visit.value(
        "master_id", self.master_id, Range{0, 127},
        "cia402: the daemon's own number on the bus, other than any servo's, for its heartbeat; 0: it sends none.");
    visit.value("counts_per_turn", self.counts_per_turn, Range{16, 1 << 28},
                "cia402: position units in a full turn of the laser, gears included.");
    visit.value("speed_units_per_count", self.speed_units_per_count, Range{1e-6, 1e6},
                "cia402: the drive's units of speed for one position unit per second; of acceleration likewise.");
    visit.flag("cyclic_position", self.cyclic_position,
               "cia402: whether the drive is given a place on its way at each SYNC (cyclic synchronous position); else "
               "it makes its way to the end by itself (profile position).");
    visit.value(
        "homing_method", self.homing_method, Range{-128, 127},
        "cia402: method by which the drive finds its zero, once after each of its power-ups (6098h); 0: none is "
        "needed.");
    visit.value("homing_speed_radps", self.homing_speed_radps, Range{0.001, 10.0}, "cia402: speed of homing.");
    visit.value("homing_timeout_ns", self.homing_timeout_ns, Range<std::int64_t>{100'000'000, 600'000'000'000},
                "cia402: longest time that homing may take.");
  }

  template <class Self, class Visitor>
  static void describe_maestro(Self& self, Visitor& visit) {
    visit.value("channel", self.channel, Range{0, 23}, "maestro: where the servo is plugged in.");
    visit.value("pulse_centre_us", self.pulse_centre_us, Range{500.0, 2500.0},
                "maestro: the pulse at the servo's centre.");
    visit.value("pulse_turn_us", self.pulse_turn_us, Range{500.0, 20'000.0},
                "maestro: by how much the pulse would change for a full turn of the laser, gears included.");
  }
};

}  // namespace odoless
