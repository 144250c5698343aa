#include "tools/experiment/task_pool.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>

namespace odoless {
namespace {

class TaskPool {
 public:
  TaskPool(std::vector<Task> tasks, const PoolProgress& progress)
      : tasks_(std::move(tasks)), shares_(tasks_.size(), 0.0), progress_(progress) {
    std::stable_sort(tasks_.begin(), tasks_.end(), [](const Task& a, const Task& b) { return a.cost_s > b.cost_s; });
  }

  void work() {
    for (std::size_t i = take(); i < tasks_.size(); i = take()) {
      try {
        tasks_[i].work([this, i](double share) { note(i, share, 0); });
        note(i, 1.0, 1);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        failure_ = failure_ ? failure_ : std::current_exception();
      }
    }
  }

  void rethrow() const {
    if (failure_) {
      std::rethrow_exception(failure_);
    }
  }

 private:
  /// The next task's index; beyond the last when there is none, or one has failed.
  std::size_t take() {
    const std::lock_guard lock(mutex_);
    return failure_ ? tasks_.size() : next_++;
  }

  void note(std::size_t task, double share, int finished) {
    const std::lock_guard lock(mutex_);
    shares_[task] = share;
    finished_ += finished;
    double cost_s = 0.0;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      cost_s += shares_[i] * tasks_[i].cost_s;
    }
    progress_(cost_s, finished_);
  }

  std::mutex mutex_;
  std::vector<Task> tasks_;
  std::vector<double> shares_;
  const PoolProgress& progress_;
  std::exception_ptr failure_;
  std::size_t next_ = 0;
  int finished_ = 0;
};

}  // namespace

void run_tasks(std::vector<Task> tasks, int threads, const PoolProgress& progress) {
  TaskPool pool(std::move(tasks), progress);
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < threads; ++i) {
      workers.emplace_back([&pool] { pool.work(); });
    }
  }
  pool.rethrow();
}

}  // namespace odoless
