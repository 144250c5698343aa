#include "firmware/web/web_threads.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <utility>

namespace odoless {

void yield_to_others() {
  constexpr int kNice = 10;
  static_cast<void>(::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice));
}

int WebThreads::start(int threads, std::size_t stack_bytes) {
  for (int i = 0; i < threads; ++i) {
    threads_.push_back(std::make_unique<RealTimeThread>(ThreadParams{.name = "odo-web", .stack_bytes = stack_bytes}));
    if (const int error = threads_.back()->start([this] { work(); }); error != 0) {
      return error;
    }
  }
  return 0;
}

WebThreads::Taken WebThreads::enqueue(std::function<void()> task) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !task_; });
  task_ = std::move(task);
  changed_.notify_all();
  changed_.wait(lock, [this] { return !task_; });
  return static_cast<Taken>(true);
}

void WebThreads::work() {
  yield_to_others();
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return task_ || ending_; });
    if (!task_) {
      return;
    }
    const std::function<void()> task = std::exchange(task_, nullptr);
    changed_.notify_all();
    lock.unlock();
    task();
    lock.lock();
  }
}

void WebThreads::end() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  for (const auto& thread : threads_) {
    thread->join();
  }
}

}  // namespace odoless
