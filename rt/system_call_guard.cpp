#include "rt/system_call_guard.hpp"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace odoless {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
#error "state the AUDIT_ARCH of this processor"
#endif

constexpr std::size_t kMaxAllowed = 2000;  // the kernel takes 4096 instructions

sock_filter load(std::size_t offset_bytes) {
  return {.code = BPF_LD | BPF_W | BPF_ABS, .jt = 0, .jf = 0, .k = static_cast<std::uint32_t>(offset_bytes)};
}

/// Goes on with the next instruction if the loaded number is `number`, with the one after that if not.
sock_filter if_equal(std::uint32_t number) {
  return {.code = BPF_JMP | BPF_JEQ | BPF_K, .jt = 0, .jf = 1, .k = number};
}

sock_filter skip(std::uint32_t instructions) { return {.code = BPF_JMP | BPF_JA, .jt = 0, .jf = 0, .k = instructions}; }

sock_filter answer(std::uint32_t action) { return {.code = BPF_RET | BPF_K, .jt = 0, .jf = 0, .k = action}; }

std::vector<sock_filter> filter_of(std::span<const int> allowed) {
  // The numbers mean something only on the processor that they are for: a call by another's convention is killed.
  std::vector<sock_filter> filter{load(offsetof(seccomp_data, arch)), if_equal(kArchitecture), skip(1),
                                  answer(SECCOMP_RET_KILL_PROCESS), load(offsetof(seccomp_data, nr))};
  for (const int number : allowed) {
    filter.push_back(if_equal(static_cast<std::uint32_t>(number)));
    filter.push_back(answer(SECCOMP_RET_ALLOW));
  }
  filter.push_back(answer(SECCOMP_RET_KILL_PROCESS));
  return filter;
}

}  // namespace

int restrict_system_calls(std::span<const int> allowed) {
  if (allowed.size() > kMaxAllowed) {
    return E2BIG;
  }
  std::vector<sock_filter> filter = filter_of(allowed);
  const sock_fprog program{.len = static_cast<std::uint16_t>(filter.size()), .filter = filter.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) {
    return errno;
  }
  return syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program) == 0 ? 0 : errno;
}

}  // namespace odoless
