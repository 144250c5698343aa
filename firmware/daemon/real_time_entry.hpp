#pragma once

#include <functional>
#include <span>

namespace odoless {

/// The system calls of each real-time thread in its loop; README.md says what for. With `enforce` a thread that makes
/// another is killed, and so is one that touches the heap, where the program has the interposed allocator.
[[nodiscard]] std::span<const int> sensor_system_calls();
[[nodiscard]] std::span<const int> worker_system_calls();

/// Runs a real-time thread's loop, held to what it may do, and ends the thread: nothing after this is done, and no
/// destructor of a thread-local object.
void run_enforced(std::span<const int> allowed_system_calls, const std::function<void()>& loop);

}  // namespace odoless
