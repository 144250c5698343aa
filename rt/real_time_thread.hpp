#pragma once

#include <pthread.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace odoless {

struct ThreadParams {
  std::string name;                                   ///< as the system shows it, which takes 15 characters of it
  int priority = 0;                                   ///< of SCHED_FIFO, 1..99; 0: an ordinary thread
  int cpu = -1;                                       ///< the only processor to run on; -1: any
  std::size_t stack_bytes = std::size_t{512} * 1024;  ///< rounded up to pages
};

/// The name of the calling thread as it was started here, or "" elsewhere. Real time: a read of a thread-local.
[[nodiscard]] const char* real_time_thread_name();

/// A thread with a stack of stated size, mapped and touched before it starts and guarded by a page below it, which sets
/// its own name, processor and SCHED_FIFO priority before its body begins.
///
/// What the system refuses (EPERM without the right to real time) doesn't keep it from running: `scheduling_error` and
/// `affinity_error` say so.
///
/// Thread: all methods from the thread that owns this object.
class RealTimeThread {
 public:
  explicit RealTimeThread(ThreadParams params);
  ~RealTimeThread();  ///< joins
  RealTimeThread(const RealTimeThread&) = delete;
  RealTimeThread& operator=(const RealTimeThread&) = delete;
  RealTimeThread(RealTimeThread&&) = delete;
  RealTimeThread& operator=(RealTimeThread&&) = delete;

  /// Starts `body`, once. Returns when the thread has set itself up: 0, or the errno for which there is no thread.
  [[nodiscard]] int start(std::function<void()> body);

  [[nodiscard]] bool started() const { return started_; }

  /// errno of setting the priority, or 0; known once started.
  [[nodiscard]] int scheduling_error() const { return scheduling_error_; }

  /// errno of setting the processor, or 0; known once started.
  [[nodiscard]] int affinity_error() const { return affinity_error_; }

  /// As the system numbers it; known once started.
  [[nodiscard]] int thread_id() const { return thread_id_; }

  /// CPU time that it has used, while it is not joined.
  [[nodiscard]] std::int64_t cpu_time_ns() const;

  /// Waits for the end of the body. Nothing to do if it has not started.
  void join();

  [[nodiscard]] const ThreadParams& params() const { return params_; }

 private:
  static void* entry(void* self);
  void set_up();
  [[nodiscard]] int map_stack();
  void unmap_stack();

  ThreadParams params_;
  std::function<void()> body_;
  void* memory_ = nullptr;  ///< guard page and stack
  std::size_t memory_bytes_ = 0;
  pthread_t thread_{};
  std::atomic<bool> is_set_up_ = false;
  bool started_ = false;
  bool joined_ = false;
  int scheduling_error_ = 0;
  int affinity_error_ = 0;
  int thread_id_ = 0;
};

}  // namespace odoless
