#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/daemon/daemon_params.hpp"

namespace odoless {

/// Memory by purpose.
struct MemoryShare {
  std::string what;
  std::size_t bytes = 0;
};

/// What a daemon with this configuration takes and locks: each part is made and measured, and the program itself, with
/// its libraries, is taken from the calling one, which is made of the same.
///
/// Thread: an ordinary one, with nobody else on the heap.
[[nodiscard]] std::vector<MemoryShare> memory_budget(const DaemonParams& params);

[[nodiscard]] std::size_t total_bytes(const std::vector<MemoryShare>& shares);

}  // namespace odoless
