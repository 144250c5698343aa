#include "tools/emulate/raw_player.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace odoless {
namespace {

constexpr std::int64_t kNeverNs = std::numeric_limits<std::int64_t>::max();

}  // namespace

RawPlayer::RawPlayer(std::vector<RawPiece> pieces, std::size_t unit_bytes)
    : pieces_(std::move(pieces)), unit_bytes_(unit_bytes), used_(pieces_.size(), false) {}

void RawPlayer::schedule(std::size_t from, std::int64_t recorded_us, std::int64_t now_ns) {
  const std::int64_t offset_ns = now_ns - recorded_us * 1000;
  std::size_t i = from;
  for (; i < pieces_.size() && !pieces_[i].to_device; ++i) {
    due_ns_[i] = pieces_[i].time_us * 1000 + offset_ns;
  }
  if (i >= next_command_) {  // a command that was left out before, and comes later, leads back to nothing
    offset_ns_ = offset_ns;
    next_command_ = i;
  }
  last_scheduled_ = last_scheduled_ || i == pieces_.size();
}

bool RawPlayer::starts_what_was_heard(const RawPiece& piece) const {
  return piece.to_device && !piece.bytes.empty() && heard_.starts_with(piece.bytes);
}

std::size_t RawPlayer::find_command() const {
  for (std::size_t i = first_unused_; i < pieces_.size(); ++i) {
    if (!used_[i] && starts_what_was_heard(pieces_[i])) {
      return i;
    }
  }
  return kNone;
}

std::size_t RawPlayer::find_used_command() const {
  for (std::size_t i = pieces_.size(); i-- > 0;) {
    if (used_[i] && starts_what_was_heard(pieces_[i])) {
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

void RawPlayer::answer_again(std::size_t command, std::int64_t now_ns) {
  ++counts_.repeated;
  heard_.erase(0, pieces_[command].bytes.size());
  const std::size_t next = command + 1;
  if (next < pieces_.size() && !pieces_[next].to_device &&
      pieces_[next].time_us - pieces_[command].time_us <= kPrompt_us) {
    repeated_.emplace(now_ns + (pieces_[next].time_us - pieces_[command].time_us) * 1000, next);
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
    } else if (const std::size_t again = find_used_command(); again != kNone) {
      answer_again(again, now_ns);
    } else if (may_become_command()) {
      return;
    } else {
      const std::size_t passed_over = std::min(unit_bytes_, heard_.size());
      heard_.erase(0, passed_over);
      counts_.unknown += static_cast<std::int64_t>(passed_over);
    }
  }
}

std::vector<std::string> RawPlayer::take_due(std::int64_t now_ns) {
  std::vector<std::string> due;
  while (!repeated_.empty() && repeated_.begin()->first <= now_ns) {
    due.push_back(pieces_[repeated_.begin()->second].bytes);
    repeated_.erase(repeated_.begin());
  }
  while (!due_ns_.empty() && due_ns_.begin()->second <= now_ns) {
    due.push_back(pieces_[due_ns_.begin()->first].bytes);
    due_ns_.erase(due_ns_.begin());
  }
  counts_.sent += static_cast<std::int64_t>(due.size());
  return due;
}

std::int64_t RawPlayer::due_ns(std::int64_t recorded_us) const {
  const bool is_known =
      was_addressed_ && (next_command_ == pieces_.size() || recorded_us < pieces_[next_command_].time_us);
  return is_known ? recorded_us * 1000 + offset_ns_ : kNeverNs;
}

std::int64_t RawPlayer::next_event_ns() const {
  return std::min(due_ns_.empty() ? kNeverNs : due_ns_.begin()->second,
                  repeated_.empty() ? kNeverNs : repeated_.begin()->first);
}

}  // namespace odoless
