#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "drivers/io/file_descriptor.hpp"
#include "rt/real_time_thread.hpp"

namespace odoless {

/// A stage, as somebody sees it who wants to know whether it lives. All of it outlives the watch.
struct WatchedStage {
  const char* name = nullptr;
  const RealTimeThread* thread = nullptr;                 ///< has started
  const std::atomic<std::uint64_t>* heartbeat = nullptr;  ///< counts the stage's rounds
  const std::atomic<bool>* done = nullptr;                ///< from then on it need not answer
};

/// Finds out for how long stages have not answered.
///
/// It counts looks and not time, so that a process that was stopped as a whole is not taken for one that hangs. And a
/// thread that could run, but has to wait for a processor, has not hung: while it is runnable only the CPU time that it
/// is given counts, as whoever loops without end uses it up.
///
/// Thread: one thread, not a real-time one.
class StageWatch {
 public:
  /// Time between two looks.
  static constexpr std::int64_t kLook_ns = 20'000'000;

  explicit StageWatch(const std::vector<WatchedStage>& stages);

  /// Looks at each stage; to be called every `kLook_ns`.
  void look();

  struct Silence {
    const char* stage = nullptr;  ///< nullptr: all have answered since the look before
    std::int64_t lasts_ns = 0;
  };
  /// The longest, at the last look.
  [[nodiscard]] Silence longest() const;

 private:
  struct Stage {
    WatchedStage seen;
    FileDescriptor state;  ///< what the kernel says of the thread
    std::uint64_t beat = 0;
    std::int64_t cpu_ns = 0;
    std::int64_t silent_ns = 0;
  };
  static void look_at(Stage& stage);

  std::vector<Stage> stages_;
};

}  // namespace odoless
