#pragma once

#include <span>

namespace odoless {

/// The system calls of each real-time thread in its loop; README.md says what for. With `enforce` a thread that makes
/// another is killed, and so is one that touches the heap, where the program has the interposed allocator.
[[nodiscard]] std::span<const int> sensor_system_calls();
[[nodiscard]] std::span<const int> worker_system_calls();

/// To be called by a real-time thread before its loop. @return 0, or the errno for which nothing is enforced.
[[nodiscard]] int enforce_real_time(std::span<const int> allowed_system_calls);

}  // namespace odoless
