#include "rt/heap_guard.hpp"

#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "rt/real_time_thread.hpp"

namespace odoless {
namespace {

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): what a thread may do is a property of the thread
thread_local std::int64_t heap_calls = 0;
thread_local bool heap_is_forbidden = false;
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

void say(const char* text, std::size_t length_bytes) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, length_bytes);
}

void say(const char* text) { say(text, std::strlen(text)); }

[[noreturn]] void abort_for(const char* function, std::size_t size_bytes) {
  std::array<char, 24> digits{};
  const char* const end = std::to_chars(digits.begin(), digits.end(), size_bytes).ptr;
  say("odoless: ");
  say(function);
  say(" of ");
  say(digits.data(), static_cast<std::size_t>(end - digits.data()));
  say(" bytes on thread '");
  say(real_time_thread_name());
  say("', which must not use the heap\n");
  std::abort();
}

}  // namespace

bool heap_is_watched() {
  const std::int64_t calls_before = heap_calls;
  // Through volatile pointers, as the compiler takes malloc for a function that changes nothing of ours.
  void* (*volatile make)(std::size_t) = &std::malloc;
  void (*volatile unmake)(void*) = &std::free;
  unmake(make(1));
  return heap_calls != calls_before;
}

std::int64_t heap_calls_on_this_thread() { return heap_calls; }

void forbid_heap_on_this_thread() { heap_is_forbidden = true; }

HeapGuard::HeapGuard() : was_forbidden_(heap_is_forbidden) { heap_is_forbidden = true; }

HeapGuard::~HeapGuard() { heap_is_forbidden = was_forbidden_; }

void note_heap_call(const char* function, std::size_t size_bytes) {
  ++heap_calls;
  if (heap_is_forbidden) {
    heap_is_forbidden = false;  // for what abort does itself
    abort_for(function, size_bytes);
  }
}

}  // namespace odoless
