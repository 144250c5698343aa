#include "rt/memory_lock.hpp"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cerrno>
#include <climits>
#include <fstream>
#include <string>

namespace odoless {

int lock_memory() {
  // NOLINTBEGIN(concurrency-mt-unsafe): called before there are threads
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_TRIM_THRESHOLD, INT_MAX);
  mallopt(M_MMAP_MAX, 0);
  // NOLINTEND(concurrency-mt-unsafe)
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
}

std::size_t locked_bytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    if (word == "VmLck:") {
      std::size_t locked_kib = 0;
      status >> locked_kib;
      return locked_kib * 1024;
    }
  }
  return 0;
}

ThreadFaults thread_page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-union-access): the C library's way to widen a field
  return {.minor = usage.ru_minflt, .major = usage.ru_majflt};
}

}  // namespace odoless
