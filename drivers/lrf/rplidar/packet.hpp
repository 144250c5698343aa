#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace odoless::rplidar {

inline constexpr std::size_t kNodeBytes = 5;
inline constexpr int kNodeType = 0x81;
inline constexpr std::size_t kDescriptorBytes = 7;

/// In lasers that triangulate, the receiver sits beside the laser, so that the mirror is some degrees past the
/// direction in which a point lies: 7 to 8 far away, less the nearer it is. That is taken off a point's angle, at most
/// so much, but not off one that nothing answered.
inline constexpr double kCompensationMaxDeg = 8.0;

enum class Command : std::uint8_t {
  kStop = 0x25,
  kReset = 0x40,
  kInfo = 0x50,
  kHealth = 0x52,
  kSampleTime = 0x59,
  kSetting = 0x84,     ///< a question for one
  kMotorDuty = 0xF0,   ///< of 1023
  kMotorSpeed = 0xA8,  ///< turns a minute
  kScan = 0x20,
  kExpress = 0x82,  ///< any scan in capsules
};

/// What is asked for with Command::kSetting; where they are of a mode, its number comes with them.
enum class Setting : std::uint16_t {
  kUsualSpeed = 0x01,  ///< turns a minute, and the motor's duty for them, 2 bytes each
  kModeSample = 0x71,  ///< what a sample takes, in 1/256 us, 4 bytes
  kModeRange = 0x74,   ///< farthest range, in 1/256 m, 4 bytes
  kModeAnswer = 0x75,  ///< type of its packets, 1 byte
  kUsualMode = 0x7C,   ///< number of the one that the maker recommends, 2 bytes
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

}  // namespace odoless::rplidar
