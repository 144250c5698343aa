#include "firmware/daemon/real_time_entry.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <array>

#include "core/base/check.hpp"
#include "rt/heap_guard.hpp"
#include "rt/system_call_guard.hpp"

namespace odoless {
namespace {

// Both: waiting and waking (ppoll, read, write on an eventfd; clock_nanosleep in a lossless replay), the CPU clock
// (clock_gettime), page faults (getrusage), the end of the thread, and of a signal handler, which a crash has. No
// futex: nobody's lock is waited for or handed on.
constexpr std::array<int, 8> kWorkerCalls{SYS_ppoll,         SYS_read,      SYS_write, SYS_clock_nanosleep,
                                          SYS_clock_gettime, SYS_getrusage, SYS_exit,  SYS_rt_sigreturn};

// Besides: the laser's line (read, write; ioctl for its rate) or a socket (recvfrom, recvmsg).
constexpr std::array<int, 11> kSensorCalls{SYS_ppoll,         SYS_read,      SYS_write,       SYS_clock_nanosleep,
                                           SYS_clock_gettime, SYS_getrusage, SYS_exit,        SYS_ioctl,
                                           SYS_recvfrom,      SYS_recvmsg,   SYS_rt_sigreturn};

}  // namespace

std::span<const int> sensor_system_calls() { return kSensorCalls; }
std::span<const int> worker_system_calls() { return kWorkerCalls; }

void run_enforced(std::span<const int> allowed_system_calls, const std::function<void()>& loop) {
  ODOLESS_CHECK(restrict_system_calls(allowed_system_calls) == 0);  // asked for, and no kernel of ours is without it
  {
    const HeapGuard no_heap;
    loop();
  }
  // At once, and joinable as ever: the C library would give back what this thread has of the heap first, under locks
  // that others may hold.
  static_cast<void>(::syscall(SYS_exit, 0));
}

}  // namespace odoless
