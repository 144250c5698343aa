#pragma once

#include <cstdint>
#include <optional>

#include "drivers/tilt/cia402/power_state.hpp"

namespace odoless::cia402 {

/// What a drive told last (TPDO 1).
struct DriveStatus {
  std::uint16_t status_word = 0;
  std::int8_t mode = 0;
};

enum class HomingState : std::uint8_t { kUnderWay, kAttained, kFailed };

/// The control word and the target for each cycle, of what the drive told in the cycle before: its mode too, by which
/// it is shown a target once (profile position) or takes it at each SYNC (cyclic synchronous position).
///
/// Thread: one thread. Real time: a few steps per call.
class Drive {
 public:
  enum class Goal : std::uint8_t {
    kStop,     ///< stopped, and kept so
    kWait,     ///< nothing is asked of a drive with a fault, nor is one enabled that isn't
    kMove,     ///< enabled and on its way to the target; a fault is reset
    kHome,     ///< enabled and finding its zero
    kRelease,  ///< without torque
  };

  struct Output {
    std::uint16_t control_word = 0;
    std::int32_t target_counts = 0;
  };

  /// Nothing is known of the drive.
  void restart() { *this = Drive(); }

  void on_status(const DriveStatus& status);
  /// The drive may have been stopped unseen: it is shown its target once more.
  void forget_target() { accepted_counts_.reset(); }
  /// Whether it is on its way to that target, or there.
  [[nodiscard]] bool has_taken(std::int32_t target_counts) const { return accepted_counts_ == target_counts; }
  [[nodiscard]] bool is_cyclic() const { return status_.mode == kCyclicPositionMode; }
  /// Once per cycle. `target_counts` counts for kMove alone; in cyclic mode always: where it is, while it isn't
  /// enabled.
  [[nodiscard]] Output next(Goal goal, std::int32_t target_counts);

  /// Nothing until it has told.
  [[nodiscard]] std::optional<PowerState> power() const { return power_; }
  [[nodiscard]] bool enabled() const { return power_ == PowerState::kEnabled; }
  [[nodiscard]] bool has_fault() const { return power_ == PowerState::kFault || power_ == PowerState::kFaultReaction; }
  [[nodiscard]] std::uint16_t status_word() const { return status_.status_word; }
  [[nodiscard]] std::int8_t mode() const { return status_.mode; }
  [[nodiscard]] HomingState homing() const;

 private:
  [[nodiscard]] std::uint16_t control(Goal goal);
  [[nodiscard]] std::uint16_t set_point_bits();
  [[nodiscard]] bool acknowledged() const { return (status_.status_word & kSetPointAcknowledged) != 0; }

  static constexpr std::int8_t kCyclicPositionMode = 8;
  static constexpr int kPatienceCycles = 30;      ///< then a step that the drive may lack is done otherwise
  static constexpr int kHomingSettlesCycles = 5;  ///< before its status says something of this homing

  DriveStatus status_;
  std::optional<PowerState> power_;
  std::uint16_t control_word_ = 0;
  std::optional<std::int32_t> accepted_counts_;  ///< the target that the drive goes to
  std::int32_t target_counts_ = 0;
  bool offers_ = false;  ///< the target is shown, the drive has not taken it yet
  int waiting_cycles_ = 0;
  int homing_cycles_ = 0;
};

}  // namespace odoless::cia402
