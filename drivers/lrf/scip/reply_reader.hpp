#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"

namespace odoless::scip {

/// The lines of one reply, without their ends; a view, valid until the reader's next call. The first is the echo.
class Reply {
 public:
  Reply(std::string_view text, std::span<const std::size_t> ends) : text_(text), ends_(ends) {}

  [[nodiscard]] int lines() const { return static_cast<int>(ends_.size()); }
  /// Empty beyond the last.
  [[nodiscard]] std::string_view line(int i) const {
    const auto index = static_cast<std::size_t>(i);
    if (index >= ends_.size()) {
      return {};
    }
    const std::size_t start = index == 0 ? 0 : ends_[index - 1];
    return text_.substr(start, ends_[index] - start);
  }

 private:
  std::string_view text_;
  std::span<const std::size_t> ends_;
};

/// Cuts received bytes into replies: lines up to an empty one.
///
/// While a stream runs, its echo also starts a reply, so that a lost line end costs one scan and not two.
/// Thread: one thread. Real time: no allocation after construction; linear in the bytes.
class ReplyReader {
 public:
  enum class Outcome {
    kMore,   ///< all bytes are used, and no reply is complete
    kReply,  ///< `reply` is complete
    kCut,    ///< bytes were thrown away: an unfinished reply that another one followed, or one longer than the memory
  };

  /// @param text_max_bytes  Room for one reply, without line ends.
  ReplyReader(std::size_t text_max_bytes, std::size_t lines_max);

  /// Takes bytes off the front of `bytes`, up to the end of a reply.
  [[nodiscard]] Outcome take(std::string_view& bytes);

  [[nodiscard]] Reply reply() const { return {{text_.data(), used_}, {ends_.data(), lines_}}; }

  /// The echo of the stream that runs, kept by the caller; empty: none does.
  void expect_stream(std::string_view echo) { stream_echo_ = echo; }

  /// Forgets what was received.
  void clear();

 private:
  [[nodiscard]] Outcome end_line();
  [[nodiscard]] std::string_view current_line() const;
  void drop_all_but(std::string_view line);

  std::vector<char> text_;
  std::vector<std::size_t> ends_;
  std::string_view stream_echo_;
  std::size_t used_ = 0;
  std::size_t lines_ = 0;
  bool complete_ = false;  ///< the next byte starts a new reply
  bool too_long_ = false;  ///< a part of this reply has been dropped
};

}  // namespace odoless::scip
