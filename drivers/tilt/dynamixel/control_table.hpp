#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

/// The part of the control tables that is used here. Addresses are those of the X series; what is lost without power
/// lies elsewhere in others, in the same order (`ControlTable::address`).
namespace odoless::dynamixel {

// Kept when power is off; can be written only without torque.
inline constexpr std::uint16_t kReturnDelay = 9;  ///< x 2 us
inline constexpr std::uint16_t kDriveMode = 10;   ///< bits
inline constexpr std::uint16_t kOperatingMode = 11;
inline constexpr std::uint16_t kAccelerationLimit = 40;  ///< 4 bytes
inline constexpr std::uint16_t kVelocityLimit = 44;      ///< 4 bytes
inline constexpr std::uint16_t kPositionMax = 48;        ///< 4 bytes
inline constexpr std::uint16_t kPositionMin = 52;        ///< 4 bytes

inline constexpr std::uint16_t kTorqueEnable = 64;
inline constexpr std::uint16_t kStatusReturnLevel = 68;
inline constexpr std::uint16_t kHardwareError = 70;
inline constexpr std::uint16_t kBusWatchdog = 98;  ///< x 20 ms, 1 to 127; 0 clears it after it has tripped
inline constexpr std::uint16_t kProfile = 108;     ///< acceleration, speed and goal position, 4 bytes each
inline constexpr std::uint16_t kGoalPosition = 116;
inline constexpr std::uint16_t kRealtimeTick = 120;  ///< 2 bytes, ms, back to 0 after 32767
inline constexpr std::uint16_t kPresentVelocity = 128;
inline constexpr std::uint16_t kPresentPosition = 132;

inline constexpr std::uint8_t kTimeBasedProfile = 0x04;  ///< of the drive mode: profiles are times, not speeds
inline constexpr std::uint8_t kPositionControl = 3;
inline constexpr std::uint8_t kAnswersAll = 2;

inline constexpr std::uint16_t kMotionFirst = kRealtimeTick;  ///< read at once: tick, moving, status, ..., position
inline constexpr std::uint16_t kMotionBytes = 16;
inline constexpr std::uint16_t kHealthFirst = kTorqueEnable;  ///< read at once: torque, ..., hardware error
inline constexpr std::uint16_t kHealthBytes = 7;
inline constexpr std::uint16_t kSettingsFirst = kReturnDelay;  ///< read at once: return delay, ..., lowest position
inline constexpr std::uint16_t kSettingsBytes = 47;

inline constexpr std::uint8_t kAlert = 0x80;  ///< of the error byte: there is a hardware error
inline constexpr std::uint8_t kErrorNumber = 0x7F;
inline constexpr std::uint8_t kCrcError = 3;

inline constexpr std::int32_t kTickWrapMs = 32768;

inline constexpr double kRevPerMinRadps = 2.0 * std::numbers::pi / 60.0;
inline constexpr double kRevPerMin2Radps2 = 2.0 * std::numbers::pi / 3600.0;

/// What differs from series to series and from model to model; by Robotis' e-manual.
struct ControlTable {
  std::uint16_t first_lost = 64;  ///< address of the torque, the first that is lost without power
  double counts_per_turn = 4096.0;
  std::int32_t centre_counts = 2048;
  double speed_unit_radps = 0.229 * kRevPerMinRadps;
  double acceleration_unit_radps2 = 214.577 * kRevPerMin2Radps2;
  bool limits_profile = false;  ///< a profile may not be beyond kAccelerationLimit and kVelocityLimit

  /// Where it has what the X series has at `address`.
  [[nodiscard]] constexpr std::uint16_t address(std::uint16_t address) const {
    return static_cast<std::uint16_t>(address < kTorqueEnable ? address : address - kTorqueEnable + first_lost);
  }
  /// The farthest that a goal may be, within one turn.
  [[nodiscard]] constexpr std::int32_t position_min() const {
    return centre_counts - static_cast<std::int32_t>(counts_per_turn / 2.0);
  }
  [[nodiscard]] constexpr std::int32_t position_max() const {
    return position_min() + static_cast<std::int32_t>(counts_per_turn) - 1;
  }
};

/// XL430, XM430, XH430, XH540 and their kin, MX with firmware for Protocol 2.0.
inline constexpr ControlTable kTableOfX{};
/// PH54, PM54, PH42, PM42, and the PRO series with firmware (A); they differ by their gears.
[[nodiscard]] constexpr ControlTable table_of_p(double counts_per_turn) {
  return {.first_lost = 512,
          .counts_per_turn = counts_per_turn,
          .centre_counts = 0,
          .speed_unit_radps = 0.01 * kRevPerMinRadps,
          .acceleration_unit_radps2 = kRevPerMin2Radps2,
          .limits_profile = true};
}

/// The table of a model, by the number that it answers a ping with. Numbers that aren't known are taken for X: each
/// year has new ones. Nothing: its table is known to be another (XL-320, PRO without (A), grippers).
[[nodiscard]] std::optional<ControlTable> control_table(std::uint32_t model_number);

inline constexpr std::uint32_t kProfileMax = 32767;

}  // namespace odoless::dynamixel
