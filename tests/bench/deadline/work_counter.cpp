#include "tests/bench/deadline/work_counter.hpp"

#include "core/base/rng.hpp"

namespace {
std::int64_t blocks = 0;
}

extern "C" void __sanitizer_cov_trace_pc();  // NOLINT(bugprone-reserved-identifier): what compilers call
extern "C" void __sanitizer_cov_trace_pc() { ++blocks; }

namespace odoless {

std::int64_t blocks_run() { return blocks; }

bool counts_blocks() {
  static const bool counts = [] {
    const std::int64_t before = blocks;
    static_cast<void>(Rng(1).next());
    return blocks > before;
  }();
  return counts;
}

}  // namespace odoless
