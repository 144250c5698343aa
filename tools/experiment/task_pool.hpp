#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/experiment/run.hpp"

namespace odoless {

/// A piece of work that needs no other.
struct Task {
  double cost_s = 0.0;  ///< estimated CPU time
  std::function<void(const ShareDone&)> work;
};

/// Called, one call at a time, with the cost done and the tasks done.
using PoolProgress = std::function<void(double, int)>;

/// Does all tasks on so many threads, the costliest first. When one throws, those under way end, no other begins, and
/// the first exception is thrown again.
void run_tasks(std::vector<Task> tasks, int threads, const PoolProgress& progress);

}  // namespace odoless
