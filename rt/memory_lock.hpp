#pragma once

#include <cstddef>
#include <cstdint>

namespace odoless {

/// Keeps all memory of the process in place, now and later, and has the heap keep what is freed (one arena, no
/// trimming, no mapping of its own for a large block): what was touched once never faults again.
///
/// Call it first thing in a program, before there are threads.
///
/// @return  0, or errno of mlockall (EPERM, ENOMEM: over the limit of locked memory). The heap is set in either case.
[[nodiscard]] int lock_memory();

/// Memory of the process that is locked: VmLck of /proc/self/status; 0 if that cannot be read.
[[nodiscard]] std::size_t locked_bytes();

struct ThreadFaults {
  std::int64_t minor = 0;  ///< a page had to be given to the process
  std::int64_t major = 0;  ///< a page had to be read from a disk
};

/// Page faults of the calling thread since it started. Real time: one system call (getrusage).
[[nodiscard]] ThreadFaults thread_page_faults();

}  // namespace odoless
