#include "tools/emulate/raw_player.hpp"

#include <limits>
#include <utility>

namespace odoless {

RawPlayer::RawPlayer(std::vector<RawPiece> pieces) : pieces_(std::move(pieces)), used_(pieces_.size(), false) {}

void RawPlayer::schedule(std::size_t from, std::int64_t recorded_us, std::int64_t now_ns) {
  std::size_t i = from;
  for (; i < pieces_.size() && !pieces_[i].to_device; ++i) {
    due_ns_[i] = now_ns + (pieces_[i].time_us - recorded_us) * 1000;
  }
  last_scheduled_ = last_scheduled_ || i == pieces_.size();
}

std::size_t RawPlayer::find_command() const {
  for (std::size_t i = first_unused_; i < pieces_.size(); ++i) {
    const RawPiece& piece = pieces_[i];
    if (piece.to_device && !used_[i] && !piece.bytes.empty() && heard_.starts_with(piece.bytes)) {
      return i;
    }
  }
  return kNone;
}

bool RawPlayer::may_become_command() const {
  for (std::size_t i = first_unused_; i < pieces_.size(); ++i) {
    if (pieces_[i].to_device && !used_[i] && std::string_view(pieces_[i].bytes).starts_with(heard_)) {
      return true;
    }
  }
  return false;
}

void RawPlayer::answer(std::size_t command, std::int64_t now_ns) {
  ++counts_.answered;
  used_[command] = true;
  heard_.erase(0, pieces_[command].bytes.size());
  schedule(command + 1, pieces_[command].time_us, now_ns);
  while (first_unused_ < pieces_.size() && (used_[first_unused_] || !pieces_[first_unused_].to_device)) {
    ++first_unused_;
  }
}

void RawPlayer::receive(std::string_view bytes, std::int64_t now_ns) {
  if (!bytes.empty() && !was_addressed_) {
    was_addressed_ = true;
    schedule(0, pieces_.empty() ? 0 : pieces_.front().time_us, now_ns);
  }
  heard_ += bytes;
  while (!heard_.empty()) {
    if (const std::size_t command = find_command(); command != kNone) {
      answer(command, now_ns);
    } else if (may_become_command()) {
      return;
    } else {
      heard_.erase(0, 1);
      ++counts_.unknown;
    }
  }
}

std::vector<std::string> RawPlayer::take_due(std::int64_t now_ns) {
  std::vector<std::string> due;
  while (!due_ns_.empty() && due_ns_.begin()->second <= now_ns) {
    due.push_back(pieces_[due_ns_.begin()->first].bytes);
    due_ns_.erase(due_ns_.begin());
  }
  counts_.sent += static_cast<std::int64_t>(due.size());
  return due;
}

std::int64_t RawPlayer::next_event_ns() const {
  return due_ns_.empty() ? std::numeric_limits<std::int64_t>::max() : due_ns_.begin()->second;
}

}  // namespace odoless
