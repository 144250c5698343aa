#pragma once

#include <cstdint>

namespace odoless {

/// Basic blocks of the core that were run so far, as a measure of its instructions that is the same on every machine
/// and under every load.
[[nodiscard]] std::int64_t blocks_run();

/// Whether the core was compiled to count them (-fsanitize-coverage=trace-pc).
[[nodiscard]] bool counts_blocks();

}  // namespace odoless
