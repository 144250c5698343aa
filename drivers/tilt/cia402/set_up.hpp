#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/tilt/cia402/canopen.hpp"
#include "drivers/tilt/tilt_motion.hpp"
#include "drivers/tilt/tilt_params.hpp"
#include "drivers/tilt/tilt_session.hpp"

namespace odoless::cia402 {

inline constexpr canopen::Object kDeviceType{0x1000, 0};
inline constexpr canopen::Object kWatchedHeartbeat{0x1016, 1};
inline constexpr canopen::Object kOwnHeartbeat{0x1017, 0};
inline constexpr canopen::Object kErrorCode{0x603F, 0};
inline constexpr canopen::Object kControlWord{0x6040, 0};
inline constexpr canopen::Object kModeOfOperation{0x6060, 0};

inline constexpr std::uint32_t kProfilePosition = 1;
inline constexpr std::uint32_t kHoming = 6;
inline constexpr std::uint32_t kCyclicPosition = 8;

/// In which it is where it isn't homed.
[[nodiscard]] constexpr std::uint32_t run_mode(const TiltParams& params) {
  return params.cyclic_position ? kCyclicPosition : kProfilePosition;
}

/// Where the drive keeps the mark that it has found its zero: the target of another mode (profile velocity), which
/// means nothing in those used here. As a drive's zero, it is lost with its power, and by nothing else that this driver
/// does.
inline constexpr canopen::Object kZeroMark{0x60FF, 0};

/// The mark: not 0, slow should it ever be taken for a speed, and another one for each method.
[[nodiscard]] constexpr std::uint32_t zero_mark(int homing_method) {
  return 0x100U | (static_cast<std::uint32_t>(homing_method) & 0xFFU);
}

/// Methods that take wherever the axis is for its zero (35 is the older number).
[[nodiscard]] constexpr bool homes_here(int homing_method) { return homing_method == 35 || homing_method == 37; }

/// One write to the drive's dictionary.
struct Setting {
  canopen::Object object;
  std::uint32_t value = 0;
  int size_bytes = 0;
  bool optional = false;  ///< a drive that refuses it will do
  bool instead = false;   ///< another value for the setting before it, should that one be refused
};

/// All that a drive is set to before it is started, in order: stop; heartbeats both ways; RPDO 1 {control word,
/// target}, TPDO 1 {status word, position, mode} and TPDO 2 {velocity} at each SYNC; limits; the profile's speed and
/// slopes.
class SetUp {
 public:
  SetUp(const TiltParams& params, const TiltScale& scale);

  [[nodiscard]] std::span<const Setting> settings() const { return std::span(settings_).first(count_); }

  /// The setting to be written after number `at`, by whether that one was refused: what stands in for it is left out
  /// where it was not.
  [[nodiscard]] std::size_t next(std::size_t at, bool was_refused) const;

  /// Whether the drive may go on although it refused `setting` so: an optional one for whatever reason that lies in
  /// the drive. What was lost or damaged on the way is no refusal.
  [[nodiscard]] static bool tolerates(const Setting& setting, std::uint32_t abort_code);

  /// What a drive lacks that refused the setting number `at` and whatever stands in for it, if that matters.
  [[nodiscard]] std::optional<TiltLack> lack_without(std::size_t at) const;

 private:
  void add(canopen::Object object, std::uint32_t value, int size_bytes, bool optional = false);
  /// What stands in for the setting before.
  void add_instead(std::uint32_t value);
  void add_pdo(std::uint16_t communication, std::uint32_t cob, std::uint8_t kind,
               std::span<const std::uint32_t> mapping);
  void add_heartbeats(const TiltParams& params);
  void add_motion(const TiltParams& params, const TiltScale& scale);
  void add_cyclic(const TiltParams& params);
  void add_homing(const TiltParams& params, const TiltScale& scale);

  std::array<Setting, 64> settings_{};
  std::size_t count_ = 0;
};

}  // namespace odoless::cia402
