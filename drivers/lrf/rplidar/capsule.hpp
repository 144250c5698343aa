#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/rplidar/packet.hpp"

namespace odoless::rplidar {

/// A capsule is some samples one after the other: two marks of 4 bits and a sum of 8, the mirror's angle at the first
/// sample, and the ranges. How the ranges are packed is what the kinds differ by.
struct CapsuleFormat {
  int type = 0;  ///< of the answer that begins its stream, and in the device's list of modes
  std::size_t bytes = 0;
  int points = 0;
  std::size_t angle_at = 0;  ///< byte
};

inline constexpr int kExpressType = 0x82;     ///< 14 bits for a range, 6 for what the device takes off its angle
inline constexpr int kUltraType = 0x84;       ///< three ranges in 32 bits, two of them by their difference: boost modes
inline constexpr int kDenseType = 0x85;       ///< 16 bits for a range
inline constexpr int kUltraDenseType = 0x86;  ///< a range and its quality in 20 bits, farther ones more coarsely
inline constexpr std::array<CapsuleFormat, 4> kCapsuleFormats{{
    {.type = kExpressType, .bytes = 84, .points = 32, .angle_at = 2},
    {.type = kUltraType, .bytes = 132, .points = 96, .angle_at = 2},
    {.type = kDenseType, .bytes = 84, .points = 40, .angle_at = 2},
    {.type = kUltraDenseType, .bytes = 170, .points = 64, .angle_at = 8},
}};
inline constexpr std::size_t kCapsuleBytesMax = 170;
inline constexpr std::size_t kCapsulePointsMax = 96;

/// The format of that type, or null.
[[nodiscard]] const CapsuleFormat* find_capsule_format(int type);

/// Whether `bytes`, as many as the format has, are such a capsule, by marks, sum and angle.
[[nodiscard]] bool is_capsule(const CapsuleFormat& format, std::span<const std::byte> bytes);

/// Whether a capsule is the first one of a stream.
[[nodiscard]] bool is_first_capsule(const CapsuleFormat& format, std::span<const std::byte> capsule);

/// The mirror's at a capsule's first sample, in degrees, 0 up to 360.
[[nodiscard]] double capsule_angle_deg(const CapsuleFormat& format, std::span<const std::byte> capsule);

/// Writes the points of a capsule, as many as the format has, from the front of `points`. The mirror was at even angles
/// between the capsule's own and that of the one after it, `sweep_deg` further on.
/// @param next  The capsule after it: an ultra capsule's last range is told by its difference from the next one's
/// first.
void read_points(const CapsuleFormat& format, std::span<const std::byte> capsule, std::span<const std::byte> next,
                 double sweep_deg, std::span<Point, kCapsulePointsMax> points);

/// By how many degrees the direction in which a point lies is behind the mirror, in lasers that triangulate: up to
/// kCompensationMaxDeg, the less the nearer.
[[nodiscard]] double compensation_deg(double range_m);

/// An ultra capsule's number of 12 bits stands for mm, in steps of 1, 2, 4, 8 or 16 mm, which are 2 to the power of
/// `level`.
struct ScaledRange {
  int range_mm = 0;
  int level = 0;
};
[[nodiscard]] ScaledRange ultra_range(unsigned scaled);
/// That a range isn't told, where there is its difference.
inline constexpr int kUltraNoDifference = 511;

/// An ultra-dense range has 10 to 13 bits, which count so many mm, from there on; its lowest two bits say which.
struct UltraDenseScale {
  unsigned bits = 0;
  int step_mm = 0;
  int from_mm = 0;
};
inline constexpr std::array<UltraDenseScale, 4> kUltraDenseScales{
    {{.bits = 10, .step_mm = 2, .from_mm = 0}, {11, 3, 2046}, {12, 4, 8187}, {13, 5, 24567}}};

}  // namespace odoless::rplidar
