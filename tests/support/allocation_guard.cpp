#include "tests/support/allocation_guard.hpp"

#include <cerrno>
#include <cstddef>

namespace odoless {
namespace {

thread_local long heap_calls = 0;

}  // namespace

AllocationGuard::AllocationGuard() : calls_before_(heap_calls) {}

long AllocationGuard::calls() const { return heap_calls - calls_before_; }

}  // namespace odoless

#if ODOLESS_COUNTS_HEAP_CALLS
// The C library's own entry points, and ours in their place; operators new and delete end up here as well.
extern "C" {
void* __libc_malloc(std::size_t size_bytes);                     // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t count, std::size_t size_bytes);  // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void* block, std::size_t size_bytes);       // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT(bugprone-reserved-identifier)
void __libc_free(void* block);                                   // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size_bytes) {
  ++odoless::heap_calls;
  return __libc_malloc(size_bytes);
}

void* calloc(std::size_t count, std::size_t size_bytes) {
  ++odoless::heap_calls;
  return __libc_calloc(count, size_bytes);
}

void* realloc(void* block, std::size_t size_bytes) {
  ++odoless::heap_calls;
  return __libc_realloc(block, size_bytes);
}

void* memalign(std::size_t alignment, std::size_t size_bytes) {
  ++odoless::heap_calls;
  return __libc_memalign(alignment, size_bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t size_bytes) { return memalign(alignment, size_bytes); }

int posix_memalign(void** block, std::size_t alignment, std::size_t size_bytes) {
  *block = memalign(alignment, size_bytes);
  return *block == nullptr ? ENOMEM : 0;
}

void free(void* block) {
  ++odoless::heap_calls;
  __libc_free(block);
}
}
#endif
