#pragma once

#include <span>

namespace odoless {

/// From here on, the calling thread may make only the system calls listed; any other kills the process (SIGSYS).
///
/// A proof and not a defence: in a test, that a real-time thread asks nothing of the kernel but what is stated; an
/// uncontended lock makes no call and is not seen. Other threads are as they were; a thread that this one starts
/// inherits the list. It can't be taken back. Calls of the vDSO (clock_gettime) aren't system calls and stay free.
///
/// Thread:    the one that is to be held, after its set-up. The C library's end of a thread makes more calls (madvise,
///            rt_sigprocmask, and futex for locks of its heap): end it by SYS_exit itself, or let it outlive the test.
/// Real time: no; allocates.
///
/// @param allowed  Numbers of system calls (SYS_... of sys/syscall.h), at most 2000.
/// @return         0, or the errno for which nothing was restricted.
[[nodiscard]] int restrict_system_calls(std::span<const int> allowed);

}  // namespace odoless
