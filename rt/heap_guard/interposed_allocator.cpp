// Stands in for the C library's heap functions in every program that links it; operators new and delete end up here
// too.
#include <cerrno>
#include <cstddef>

#include "rt/heap_guard.hpp"

#if ODOLESS_HEAP_CAN_BE_WATCHED
extern "C" {
void* __libc_malloc(std::size_t size_bytes);
void* __libc_calloc(std::size_t count, std::size_t size_bytes);
void* __libc_realloc(void* block, std::size_t size_bytes);
void* __libc_memalign(std::size_t alignment_bytes, std::size_t size_bytes);
void __libc_free(void* block);

void* malloc(std::size_t size_bytes) {
  odoless::note_heap_call("malloc", size_bytes);
  return __libc_malloc(size_bytes);
}

void* calloc(std::size_t count, std::size_t size_bytes) {
  odoless::note_heap_call("calloc", count * size_bytes);
  return __libc_calloc(count, size_bytes);
}

void* realloc(void* block, std::size_t size_bytes) {
  odoless::note_heap_call("realloc", size_bytes);
  return __libc_realloc(block, size_bytes);
}

void* memalign(std::size_t alignment_bytes, std::size_t size_bytes) {
  odoless::note_heap_call("memalign", size_bytes);
  return __libc_memalign(alignment_bytes, size_bytes);
}

void* aligned_alloc(std::size_t alignment_bytes, std::size_t size_bytes) {
  return memalign(alignment_bytes, size_bytes);
}

int posix_memalign(void** block, std::size_t alignment_bytes, std::size_t size_bytes) {
  void* const made = memalign(alignment_bytes, size_bytes);
  if (made == nullptr) {
    return ENOMEM;
  }
  *block = made;
  return 0;
}

void free(void* block) {
  odoless::note_heap_call("free", 0);
  __libc_free(block);
}
}
#endif
