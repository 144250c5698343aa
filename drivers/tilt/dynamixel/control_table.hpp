#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

/// The part of the control table of the X series (XL430, XM430, XH430 and their kin) that is used here, with its units;
/// by Robotis' data sheets of the XH430-W350 and XH430-V350.
namespace odoless::dynamixel {

// Kept when power is off; can be written only without torque.
inline constexpr std::uint16_t kReturnDelay = 9;  ///< x 2 us
inline constexpr std::uint16_t kDriveMode = 10;   ///< bits
inline constexpr std::uint16_t kOperatingMode = 11;
inline constexpr std::uint16_t kPositionMax = 48;  ///< 4 bytes
inline constexpr std::uint16_t kPositionMin = 52;  ///< 4 bytes

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

inline constexpr double kCountsPerTurn = 4096.0;
inline constexpr double kCentreCounts = 2048.0;
inline constexpr std::int32_t kTickWrapMs = 32768;
inline constexpr double kSpeedUnitRadps = 0.229 * 2.0 * std::numbers::pi / 60.0;              ///< 0.229 rev/min
inline constexpr double kAccelerationUnitRadps2 = 214.577 * 2.0 * std::numbers::pi / 3600.0;  ///< 214.577 rev/min2
inline constexpr std::uint32_t kProfileMax = 32767;

}  // namespace odoless::dynamixel
