// All memory of a program from one block that it brings, as a robot's firmware needs it that has no heap: malloc, which
// operator new asks too, gives from the block. At its end the program says on stderr how much of it was taken.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory_resource>
#include <new>

namespace {

alignas(4096) std::array<std::byte, OWN_MEMORY_BYTES> memory;
std::size_t taken = 0;

void say(const char* more) { std::fprintf(stderr, "%zu of %zu bytes taken%s\n", taken, memory.size(), more); }

/// Gives from the block's beginning to its end.
class Block final : public std::pmr::memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    const std::size_t begin = (taken + alignment - 1) / alignment * alignment;
    if (begin > memory.size() || bytes > memory.size() - begin) {
      say(", and more are asked for");
      std::_Exit(71);
    }
    taken = begin + bytes;
    return &memory[begin];
  }
  void do_deallocate(void* /*at*/, std::size_t /*bytes*/, std::size_t /*alignment*/) override {}
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
};

/// Takes back what is freed, but for pieces larger than a pool holds. Never destroyed: something may be freed last.
std::pmr::memory_resource& pools() {
  alignas(Block) static std::byte block[sizeof(Block)];
  using Pools = std::pmr::unsynchronized_pool_resource;
  alignas(Pools) static std::byte pools[sizeof(Pools)];
  static auto* const made =
      new (pools) Pools({.max_blocks_per_chunk = 4, .largest_required_pool_block = 1 << 16}, new (block) Block);
  return *made;
}

/// Before each piece: where it begins, and how long it is with what is before it.
struct Head {
  void* begin;
  std::size_t bytes;
  std::size_t alignment;
  std::size_t asked;
};

const Head& head_of(void* piece) { return static_cast<const Head*>(piece)[-1]; }

void* give(std::size_t asked, std::size_t alignment) {
  alignment = std::max(alignment, alignof(std::max_align_t));
  const std::size_t before = (sizeof(Head) + alignment - 1) / alignment * alignment;
  auto* const begin = static_cast<std::byte*>(pools().allocate(before + asked, alignment));
  new (begin + before - sizeof(Head)) Head{begin, before + asked, alignment, asked};
  return begin + before;
}

const struct AtTheEnd {
  ~AtTheEnd() { say(""); }
} at_the_end;

}  // namespace

extern "C" {

void* malloc(std::size_t bytes) { return give(bytes, 1); }
void* aligned_alloc(std::size_t alignment, std::size_t bytes) { return give(bytes, alignment); }
void* calloc(std::size_t count, std::size_t bytes) { return std::memset(give(count * bytes, 1), 0, count * bytes); }
void free(void* piece) {
  if (piece != nullptr) {
    const Head head = head_of(piece);
    pools().deallocate(head.begin, head.bytes, head.alignment);
  }
}
void* realloc(void* piece, std::size_t bytes) {
  void* const other = give(bytes, 1);
  if (piece != nullptr) {
    std::memcpy(other, piece, std::min(bytes, head_of(piece).asked));
    free(piece);
  }
  return other;
}

}  // extern "C"
