#include "rt/real_time_thread.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <ctime>
#include <utility>

#include "core/base/check.hpp"

namespace odoless {
namespace {

// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): a property of the thread
thread_local const char* name_of_this_thread = "";

// ThreadSanitizer keeps almost a megabyte of its own on every thread's stack.
#if defined(__SANITIZE_THREAD__)
constexpr std::size_t kSanitizer_bytes = std::size_t{1} << 20;
#else
constexpr std::size_t kSanitizer_bytes = 0;
#endif

std::size_t page_bytes() { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }

int set_affinity(int cpu) {
  if (cpu < 0) {
    return 0;
  }
  if (cpu >= CPU_SETSIZE) {
    return EINVAL;
  }
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(static_cast<std::size_t>(cpu), &only);
  return pthread_setaffinity_np(pthread_self(), sizeof(only), &only);
}

int set_priority(int priority) {
  if (priority == 0) {
    return 0;
  }
  const sched_param scheduling{.sched_priority = priority};
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &scheduling);
}

}  // namespace

const char* real_time_thread_name() { return name_of_this_thread; }

RealTimeThread::RealTimeThread(ThreadParams params) : params_(std::move(params)) {}

RealTimeThread::~RealTimeThread() {
  join();
  unmap_stack();
}

int RealTimeThread::start(std::function<void()> body) {
  ODOLESS_CHECK(!started_ && memory_ == nullptr);
  body_ = std::move(body);
  if (const int error = map_stack(); error != 0) {
    return error;
  }
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  int error =
      pthread_attr_setstack(&attributes, static_cast<char*>(memory_) + page_bytes(), memory_bytes_ - page_bytes());
  if (error == 0) {
    error = pthread_create(&thread_, &attributes, &RealTimeThread::entry, this);
  }
  pthread_attr_destroy(&attributes);
  if (error != 0) {
    unmap_stack();
    return error;
  }
  is_set_up_.wait(false);
  started_ = true;
  return 0;
}

std::int64_t RealTimeThread::cpu_time_ns() const {
  constexpr std::int64_t kNsPerS = 1'000'000'000;
  clockid_t clock{};
  timespec used{};
  if (pthread_getcpuclockid(thread_, &clock) != 0 || clock_gettime(clock, &used) != 0) {
    return 0;  // it has ended
  }
  return used.tv_sec * kNsPerS + used.tv_nsec;
}

void RealTimeThread::join() {
  if (started_ && !joined_) {
    pthread_join(thread_, nullptr);
    joined_ = true;
  }
}

void* RealTimeThread::entry(void* self) {
  auto* const thread = static_cast<RealTimeThread*>(self);
  thread->set_up();
  thread->body_();
  return nullptr;
}

void RealTimeThread::set_up() {
  name_of_this_thread = params_.name.c_str();
  pthread_setname_np(pthread_self(), params_.name.substr(0, 15).c_str());
  thread_id_ = gettid();
  affinity_error_ = set_affinity(params_.cpu);
  scheduling_error_ = set_priority(params_.priority);
  is_set_up_ = true;
  is_set_up_.notify_one();
}

int RealTimeThread::map_stack() {
  const std::size_t page = page_bytes();
  const std::size_t wanted_bytes = std::max(params_.stack_bytes, static_cast<std::size_t>(PTHREAD_STACK_MIN));
  memory_bytes_ = page + (wanted_bytes + kSanitizer_bytes + page - 1) / page * page;
  memory_ = mmap(nullptr, memory_bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK | MAP_POPULATE,
                 -1, 0);
  if (memory_ == MAP_FAILED) {
    memory_ = nullptr;
    return errno;
  }
  if (mprotect(memory_, page, PROT_NONE) != 0) {
    const int error = errno;
    unmap_stack();
    return error;
  }
  return 0;
}

void RealTimeThread::unmap_stack() {
  if (memory_ != nullptr) {
    munmap(memory_, memory_bytes_);
    memory_ = nullptr;
  }
}

}  // namespace odoless
