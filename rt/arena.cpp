#include "rt/arena.hpp"

#include <sys/mman.h>
#include <unistd.h>

namespace odoless {

Arena::Arena(std::size_t capacity_bytes) {
  const auto page_bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const std::size_t pages = capacity_bytes / page_bytes + (capacity_bytes % page_bytes == 0 ? 0 : 1);
  const std::size_t mapped_bytes = pages * page_bytes;
  if (mapped_bytes < capacity_bytes || mapped_bytes == 0) {
    return;
  }
  void* const mapped =
      mmap(nullptr, mapped_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  if (mapped != MAP_FAILED) {
    memory_ = static_cast<std::byte*>(mapped);
    capacity_bytes_ = mapped_bytes;
  }
}

Arena::~Arena() {
  if (memory_ != nullptr) {
    munmap(memory_, capacity_bytes_);
  }
}

void* Arena::take(std::size_t size_bytes, std::size_t alignment_bytes) {
  void* next = memory_ + used_bytes_;
  std::size_t room_bytes = capacity_bytes_ - used_bytes_;
  if (memory_ == nullptr || std::align(alignment_bytes, size_bytes, next, room_bytes) == nullptr) {
    return nullptr;
  }
  used_bytes_ = capacity_bytes_ - room_bytes + size_bytes;
  return next;
}

}  // namespace odoless
