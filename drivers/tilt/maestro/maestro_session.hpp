#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/tilt/maestro/command.hpp"
#include "drivers/tilt/tilt_motion.hpp"
#include "drivers/tilt/tilt_session.hpp"

namespace odoless {

/// An RC servo at a Pololu Maestro, which makes the pulses and their ramp:
///
///   1. asked for its errors, which a new line has had reason for; told the speed and acceleration of the channel;
///   2. asked for the channel's position per sample_period_ns, and shown each new target once.
///
/// The position is the pulse that the Maestro sends: nobody measures where the servo is. So a stall isn't seen, and an
/// angle is where the axis should be. A channel without a pulse (position 0: off, or the Maestro has started anew) gets
/// one at once for the level pose or the sweep, and none for a stop. One that doesn't answer three times goes back
/// to 1. A stop is a target at the braking distance. Contract: see TiltSession, but for what follows of this.
class MaestroSession final : public TiltSession {
 public:
  explicit MaestroSession(const TiltParams& params);

  void reset(std::int64_t now_ns) override;
  void command(TiltCommand command, std::int64_t now_ns) override;
  void finish(TiltEnd end, std::int64_t now_ns) override;
  [[nodiscard]] bool is_finished() const override { return step_ == Step::kEnded; }
  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, TiltSink& sink) override;
  [[nodiscard]] std::span<const std::byte> transmit() override;
  void tick(std::int64_t now_ns, TiltSink& sink) override;
  [[nodiscard]] std::int64_t next_deadline_ns() const override;
  [[nodiscard]] TiltState state() const override;
  [[nodiscard]] const TiltCounters& counters() const override { return counters_; }

 private:
  enum class Step : std::uint8_t {
    kFind,  ///< asked for its errors
    kRun,
    kPause,
    kEnd,  ///< told how it is left, and asked for its position, whose answer confirms that it has heard
    kEnded,
  };

  void find(std::int64_t now_ns);
  void ask_position(std::int64_t now_ns);
  void ask_errors(std::int64_t now_ns);
  void ask(std::int64_t now_ns);
  void on_answer(unsigned number, std::int64_t arrival_ns, TiltSink& sink);
  void on_errors(unsigned flags, std::int64_t now_ns, TiltSink& sink);
  void on_position(unsigned counts, std::int64_t arrival_ns, TiltSink& sink);
  void forget_what_it_was_told();
  void on_timeout(std::int64_t now_ns, TiltSink& sink);
  void give_up(Errc reason, std::int64_t now_ns, TiltSink& sink);
  /// The target for what it was told, or nothing: a stop of what doesn't move.
  [[nodiscard]] std::optional<unsigned> wished_counts() const;
  [[nodiscard]] unsigned counts_of(double angle_rad) const;

  TiltParams params_;
  TiltScale scale_;
  TiltMotion motion_;
  TiltCounters counters_;
  unsigned speed_units_;
  unsigned acceleration_units_;

  Step step_ = Step::kPause;
  bool was_reset_ = false;
  bool ready_ = false;
  bool silence_told_ = false;
  bool wants_errors_ = false;  ///< what was asked for is the errors
  bool busy_ = false;
  bool to_be_sent_ = false;
  int tries_ = 0;
  int polls_ = 0;
  TiltEnd end_ = TiltEnd::kHold;
  std::int64_t asked_ns_ = 0;
  std::int64_t next_poll_ns_ = 0;
  std::int64_t last_stamp_ns_ = 0;

  unsigned position_counts_ = maestro::kNoPulse;
  std::optional<unsigned> target_counts_;  ///< as the Maestro has it
  bool target_is_stop_ = false;
  bool has_profile_ = false;  ///< the Maestro has been told it

  maestro::Commands commands_;
  std::array<std::byte, maestro::kAnswerBytes> answer_{};
  std::size_t answer_size_ = 0;
};

}  // namespace odoless
