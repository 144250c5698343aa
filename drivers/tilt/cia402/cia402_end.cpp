#include "drivers/tilt/cia402/cia402_session.hpp"

// How a session leaves its drive when the daemon ends.
namespace odoless {

// A drive that is brought up was told to stop by its first setting.
void Cia402Session::finish(TiltEnd end, std::int64_t now_ns) {
  const bool can_move = phase_ == Phase::kRun && !in_fault_;
  end_ = end == TiltEnd::kLevel && !can_move ? TiltEnd::kHold : end;
  motion_.command(end_ == TiltEnd::kLevel ? TiltCommand::kLevel : TiltCommand::kStop, now_ns);
  if (is_cyclic()) {
    next_sync_ns_ = now_ns;
    enter(Phase::kEnd, now_ns);
    return;
  }
  sdo_.cancel();
  if (was_reset_ && end_ == TiltEnd::kRelease) {
    send(canopen::sdo_write(params_.id, cia402::kControlWord, cia402::kDisableVoltage, 2));
  }
  phase_ = Phase::kEnded;
}

bool Cia402Session::is_left_as_wished() const {
  const std::optional<cia402::PowerState> power = drive_.power();
  if (!power || sdo_.busy()) {
    return false;
  }
  switch (end_) {
    case TiltEnd::kLevel:
      return drive_.has_taken(scale_.position_counts(motion_.target_rad()));
    case TiltEnd::kHold:
      return !drive_.enabled();
    case TiltEnd::kRelease:
      break;
  }
  return !drive_.enabled() && power != cia402::PowerState::kQuickStop;
}

// Watched or not, it is left; one that cannot go to level by itself is stopped.
void Cia402Session::on_end_written(bool is_done, std::int64_t now_ns) {
  if (sdo_.object() != cia402::kModeOfOperation) {
    return;
  }
  if (!is_done) {
    end_ = TiltEnd::kHold;
    motion_.command(TiltCommand::kStop, now_ns);
  }
  if (params_.master_id != 0) {
    sdo_.write(cia402::kWatchedHeartbeat, 0, 4, now_ns);
    send_sdo();
  }
}

}  // namespace odoless
