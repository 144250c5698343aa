#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/emulate/raw_recording.hpp"

namespace odoless {

/// What became of a recording that is played.
struct RawPlayCounts {
  std::int64_t answered = 0;  ///< recorded commands that the client has sent
  std::int64_t sent = 0;      ///< recorded pieces that were sent to it
  std::int64_t repeated = 0;  ///< commands beyond the recorded ones, whose answers were repeated
  std::int64_t unknown = 0;   ///< bytes that it sent and that are no command of the record
};

/// A device that says again what it said when it was recorded, whoever it was.
///
/// The record's bytes to the device are commands: what followed one of them, up to the next, is sent when the client
/// has sent the same bytes, as long after it as it was recorded. The first such command that isn't used up counts, so
/// that a client may leave some out or send them in another order. What stands before all commands is sent at the first
/// byte of the client. Pieces are never sent in another order than the recorded one.
///
/// A client that sends a command more often than it was recorded, as after a restart, gets the first piece of its last
/// answer once more, and the rest goes on as it would have.
///
/// Bytes and the host's time in, bytes out; one thread.
class RawPlayer {
 public:
  /// @param unit_bytes  What comes from the client is passed over in such steps where it is not known: 1, or a frame.
  explicit RawPlayer(std::vector<RawPiece> pieces, std::size_t unit_bytes = 1);

  void receive(std::string_view bytes, std::int64_t now_ns);
  /// The pieces that are due.
  [[nodiscard]] std::vector<std::string> take_due(std::int64_t now_ns);
  /// When the next one is; far in the future: none is.
  [[nodiscard]] std::int64_t next_event_ns() const;

  /// When something that was recorded then, on another line, is due, so that both stay together; far in the future:
  /// before it, this device was sent a command that the client hasn't sent yet, or it was never spoken to at all.
  [[nodiscard]] std::int64_t due_ns(std::int64_t recorded_us) const;

  /// Everything that answers the last command that was sent so far, and all before, was sent, and none is left.
  [[nodiscard]] bool is_over() const { return last_scheduled_ && due_ns_.empty(); }
  [[nodiscard]] const RawPlayCounts& counts() const { return counts_; }

 private:
  static constexpr std::size_t kNone = SIZE_MAX;
  static constexpr std::int64_t kPrompt_us = 100'000;  ///< later, it is a stream and no answer

  /// The first command, of those that aren't used up, at the start of what the client has sent.
  [[nodiscard]] std::size_t find_command() const;
  /// The last one of those that are.
  [[nodiscard]] std::size_t find_used_command() const;
  [[nodiscard]] bool may_become_command() const;
  void answer(std::size_t command, std::int64_t now_ns);
  void answer_again(std::size_t command, std::int64_t now_ns);
  [[nodiscard]] bool starts_what_was_heard(const RawPiece& piece) const;
  /// Schedules what follows piece `from`, up to the next command.
  void schedule(std::size_t from, std::int64_t recorded_us, std::int64_t now_ns);

  std::vector<RawPiece> pieces_;
  std::size_t unit_bytes_;
  std::vector<bool> used_;
  std::size_t first_unused_ = 0;
  std::map<std::size_t, std::int64_t> due_ns_;         ///< of pieces that wait, by their place in the record
  std::multimap<std::int64_t, std::size_t> repeated_;  ///< answers that are sent once more, by when they are due
  std::string heard_;
  bool was_addressed_ = false;
  std::int64_t offset_ns_ = 0;    ///< from a recorded time to when it is played, since the last answer
  std::size_t next_command_ = 0;  ///< the first behind that answer
  bool last_scheduled_ = false;
  RawPlayCounts counts_;
};

}  // namespace odoless
