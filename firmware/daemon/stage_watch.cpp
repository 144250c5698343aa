#include "firmware/daemon/stage_watch.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace odoless {
namespace {

// /proc/PID/task/TID/stat: "number (name) state ...", where the name may have parentheses.
bool is_runnable(int stat) {
  std::array<char, 256> text{};
  const ssize_t size_bytes = ::pread(stat, text.data(), text.size(), 0);
  const std::string_view read(text.data(), static_cast<std::size_t>(std::max<ssize_t>(size_bytes, 0)));
  const std::size_t end = read.rfind(')');
  return end != std::string_view::npos && read.substr(end).starts_with(") R");
}

}  // namespace

StageWatch::StageWatch(const std::vector<WatchedStage>& stages) {
  for (const WatchedStage& seen : stages) {
    const std::string path = fmt::format("/proc/self/task/{}/stat", seen.thread->thread_id());
    stages_.push_back({.seen = seen, .state = FileDescriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC))});
  }
}

void StageWatch::look() { std::for_each(stages_.begin(), stages_.end(), &StageWatch::look_at); }

void StageWatch::look_at(Stage& stage) {
  const std::uint64_t beat = stage.seen.heartbeat->load(std::memory_order_relaxed);
  if (beat != std::exchange(stage.beat, beat) || *stage.seen.done) {
    stage.silent_ns = 0;
    stage.cpu_ns = 0;
    return;
  }
  const std::int64_t cpu_ns = stage.seen.thread->cpu_time_ns();
  const std::int64_t used_ns = stage.cpu_ns > 0 ? cpu_ns - stage.cpu_ns : 0;
  stage.cpu_ns = cpu_ns;
  stage.silent_ns += is_runnable(stage.state.get()) ? std::min(used_ns, kLook_ns) : kLook_ns;
}

StageWatch::Silence StageWatch::longest() const {
  const auto longest = std::max_element(stages_.begin(), stages_.end(),
                                        [](const Stage& a, const Stage& b) { return a.silent_ns < b.silent_ns; });
  return longest == stages_.end() || longest->silent_ns == 0 ? Silence{}
                                                             : Silence{longest->seen.name, longest->silent_ns};
}

}  // namespace odoless
