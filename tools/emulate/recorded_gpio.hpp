#pragma once

#include <array>
#include <functional>
#include <vector>

#include "tools/emulate/raw_recording.hpp"
#include "tools/emulate/robot_wires.hpp"

namespace odoless {

/// A robot's wires as they were recorded: emergency stop and sync pulses.
///
/// An input begins at the level that was recorded first, and a lost line keeps its level: no wire can be lost from its
/// far end. No change of the stop is left out, however late; pulses are, as RobotWires has it.
class RecordedGpio final : public RobotWires {
 public:
  /// When what was recorded then is due (RawPlayer::due_ns); far in the future: not known yet.
  using DueTime = std::function<std::int64_t(std::int64_t recorded_us)>;

  /// @throws DataError of a piece that is no change; `path` is named in it.
  RecordedGpio(const std::vector<RawPiece>& pieces, DueTime due_ns, const std::filesystem::path& path);

  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_event_ns() const override;
  [[nodiscard]] bool is_high(GpioPin input) const override { return is_high_.at(static_cast<std::size_t>(input)); }

  [[nodiscard]] std::size_t recorded() const { return edges_.size(); }
  [[nodiscard]] std::size_t played() const { return next_; }

 private:
  struct Edge {
    std::int64_t time_us;
    GpioPin pin;
    bool high;
  };

  DueTime due_ns_;
  std::vector<Edge> edges_;
  std::size_t next_ = 0;
  std::array<bool, kGpioInputs> is_high_{true, false};  ///< not recorded: not pressed, no pulse
};

}  // namespace odoless
