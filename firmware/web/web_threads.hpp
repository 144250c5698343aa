#pragma once

#include <httplib.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "rt/real_time_thread.hpp"

namespace odoless {

/// Ordinary threads, behind all others of the process, each for one connection as long as that lasts. A connection for
/// which there is none waits in the kernel: whoever accepts it waits for a thread first.
class WebThreads final : public httplib::TaskQueue {
 public:
  WebThreads() = default;
  ~WebThreads() override { end(); }
  WebThreads(const WebThreads&) = delete;
  WebThreads& operator=(const WebThreads&) = delete;
  WebThreads(WebThreads&&) = delete;
  WebThreads& operator=(WebThreads&&) = delete;

  /// 0, or the errno for which there are fewer.
  [[nodiscard]] int start(int threads, std::size_t stack_bytes);

  /// Nothing with cpp-httplib 0.11 of Debian 12, bool with later ones.
  using Taken = decltype(std::declval<httplib::TaskQueue&>().enqueue(nullptr));

  /// Returns when a thread has taken it.
  Taken enqueue(std::function<void()> task) override;
  /// Ends when every task has.
  void shutdown() override { end(); }

 private:
  void end();
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> task_;  ///< that no thread has taken yet
  bool ending_ = false;
  std::vector<std::unique_ptr<RealTimeThread>> threads_;
};

/// The calling thread is served after all others that are not real-time.
void yield_to_others();

}  // namespace odoless
