#include "tools/output/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr std::int64_t kRedrawNs = 100'000'000;
constexpr std::int64_t kLineNs = 30'000'000'000;
constexpr double kSecondsPerNanosecond = 1e-9;
constexpr std::size_t kLineCharactersMax = 100;
constexpr std::size_t kBarCharacters = 24;

std::string format_time_left(const ProgressState& state) {
  if (state.done <= 0) {
    return "-:--";
  }
  const auto left = static_cast<double>(state.total - state.done);
  const auto left_s = std::llround(state.elapsed_s / static_cast<double>(state.done) * std::max(left, 0.0));
  return fmt::format("{}:{:02}", left_s / 60, left_s % 60);
}

}  // namespace

std::string format_progress(const ProgressState& state, std::string_view note) {
  const double share = state.total > 0 ? static_cast<double>(state.done) / static_cast<double>(state.total) : 0.0;
  const double bounded_share = std::clamp(share, 0.0, 1.0);
  const auto full = static_cast<std::size_t>(bounded_share * static_cast<double>(kBarCharacters));
  const double rate_hz = state.elapsed_s > 0.0 ? static_cast<double>(state.done) / state.elapsed_s : 0.0;
  const std::string bar = std::string(full, '#').append(kBarCharacters - full, '.');
  const std::string line =
      fmt::format("[{}] {:3.0f} %  {}/{}  {:.1f}/s  {} left  {}", bar, std::floor(100.0 * bounded_share), state.done,
                  state.total, rate_hz, format_time_left(state), note);
  return line.substr(0, kLineCharactersMax);
}

Progress::Progress(std::int64_t total, InPipe in_pipe)
    : Progress(total, stderr, &monotonic_ns, isatty(fileno(stderr)) == 1) {
  output_ = is_terminal_ || in_pipe == InPipe::kLines ? output_ : nullptr;
}

Progress::Progress(std::int64_t total, std::FILE* output, Clock now_ns, bool is_terminal)
    : output_(output),
      is_terminal_(is_terminal),
      now_ns_(now_ns),
      total_(total),
      start_ns_(now_ns()),
      drawn_ns_(is_terminal ? start_ns_ - kRedrawNs : start_ns_) {}

void Progress::update(std::int64_t done, std::string_view note) {
  if (output_ == nullptr) {
    return;
  }
  const std::int64_t now_ns = now_ns_();
  const bool is_due = now_ns - drawn_ns_ >= (is_terminal_ ? kRedrawNs : kLineNs);
  if (!is_due && (!is_terminal_ || done < total_)) {
    return;
  }
  drawn_ns_ = now_ns;
  is_drawn_ = is_terminal_;
  const double elapsed_s = static_cast<double>(now_ns - start_ns_) * kSecondsPerNanosecond;
  const std::string line = format_progress({done, total_, elapsed_s}, note);
  if (is_terminal_) {
    fmt::print(output_, "\r{}\x1b[K", line);  // back to the line's start; clears what the last line was longer
  } else {
    fmt::print(output_, "{}\n", line);
  }
  static_cast<void>(std::fflush(output_));
}

Progress::~Progress() {
  if (is_drawn_) {
    static_cast<void>(std::fputc('\n', output_));
  }
}

}  // namespace odoless
