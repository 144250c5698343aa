#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "rt/cpu_clock.hpp"

namespace odoless {

/// How far a job is.
struct ProgressState {
  std::int64_t done = 0;
  std::int64_t total = 0;
  double elapsed_s = 0.0;
};

/// One line such as `[######......]  50 %  1234/2468  312.4/s  0:04 left  fitness 0.93`, at most 100 characters.
[[nodiscard]] std::string format_progress(const ProgressState& state, std::string_view note);

/// What is shown where the output is no terminal.
enum class InPipe { kNothing, kLines };

/// Shows on a terminal how far a job is, at most 10 times a second. Elsewhere it is silent, or writes a line every 30
/// s, so that a short job leaves nothing. Whatever way the job ends, the bar's line is ended too.
class Progress {
 public:
  using Clock = std::int64_t (*)();

  explicit Progress(std::int64_t total, InPipe in_pipe = InPipe::kNothing);
  /// For tests: any output, taken for a terminal or for a pipe with lines, and any clock in nanoseconds.
  Progress(std::int64_t total, std::FILE* output, Clock now_ns, bool is_terminal = true);
  Progress(const Progress&) = delete;
  Progress(Progress&&) = delete;
  Progress& operator=(const Progress&) = delete;
  Progress& operator=(Progress&&) = delete;
  ~Progress();

  /// `done` of the total are done; `note` stands behind the figures. Cheap between two redraws.
  void update(std::int64_t done, std::string_view note);

 private:
  std::FILE* output_;  ///< null: silent
  bool is_terminal_;
  Clock now_ns_;
  std::int64_t total_;
  std::int64_t start_ns_;
  std::int64_t drawn_ns_;
  bool is_drawn_ = false;
};

}  // namespace odoless
