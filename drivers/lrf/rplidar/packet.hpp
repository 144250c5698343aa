#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace odoless::rplidar {

inline constexpr std::size_t kNodeBytes = 5;
inline constexpr std::size_t kCapsuleBytes = 84;
inline constexpr int kCapsulePoints = 32;
inline constexpr std::size_t kDescriptorBytes = 7;

/// The receiver sits beside the laser, so that the mirror is some degrees past the direction in which a point lies: 7
/// to 8 far away, less the nearer it is. The device takes that off a point's angle, at most so much, but not off one
/// that nothing answered.
inline constexpr double kCompensationMaxDeg = 8.0;

enum class Command : std::uint8_t {
  kStop = 0x25,
  kReset = 0x40,
  kInfo = 0x50,
  kHealth = 0x52,
  kSampleTime = 0x59,
  kMotor = 0xF0,
  kScan = 0x20,
  kExpress = 0x82,
};

/// A request to the device: its command and, where it has a payload, that with its sum.
class Request {
 public:
  Request() = default;
  explicit Request(Command command, std::span<const std::byte> payload = {});
  [[nodiscard]] std::span<const std::byte> bytes() const { return {bytes_.data(), size_}; }

 private:
  std::array<std::byte, 16> bytes_{};
  std::size_t size_ = 0;
};

/// What an answer starts with.
struct Descriptor {
  std::size_t length_bytes = 0;  ///< of the data, or of each packet of a stream
  bool is_stream = false;
  int type = 0;
};

/// Reads an answer's first 7 bytes; nothing where they are none.
[[nodiscard]] std::optional<Descriptor> descriptor_of(std::span<const std::byte> bytes);

/// One measurement.
struct Point {
  double angle_deg = 0.0;  ///< clockwise from the front, 0 up to 360; the mirror's where the range is 0
  double range_m = 0.0;    ///< 0: nothing can be said, or nothing was hit
  bool starts_turn = false;
};

/// A measurement of the standard scan, 5 bytes. Nothing where the two check bits or the angle are wrong.
[[nodiscard]] std::optional<Point> node_of(std::span<const std::byte> bytes);

/// Whether 84 bytes are a capsule of the express scan, by its two marks and its sum.
[[nodiscard]] bool is_capsule(std::span<const std::byte> bytes);

/// Whether a capsule is the first one of a stream.
[[nodiscard]] bool is_first_capsule(std::span<const std::byte> capsule);

/// Angle of a capsule's first point before its compensation, in degrees, 0 up to 360.
[[nodiscard]] double capsule_angle_deg(std::span<const std::byte> capsule);

/// The points of a capsule; their angles lie evenly between its own and the next one's, `sweep_deg` further on, each
/// less its compensation.
[[nodiscard]] std::array<Point, kCapsulePoints> points_of(std::span<const std::byte> capsule, double sweep_deg);

}  // namespace odoless::rplidar
