#include "rt/wake_up.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <ctime>

#include "core/base/check.hpp"

namespace odoless {
namespace {

timespec to_timespec(std::int64_t duration_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  return {.tv_sec = duration_ns / kSecond_ns, .tv_nsec = duration_ns % kSecond_ns};
}

}  // namespace

WakeUp::WakeUp() : descriptor_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) { ODOLESS_CHECK(descriptor_ >= 0); }

WakeUp::~WakeUp() { close(descriptor_); }

void WakeUp::notify() const {
  const std::uint64_t one = 1;
  // Fails only if the count is at its end: then the sleeper has been told already.
  [[maybe_unused]] const ssize_t written = write(descriptor_, &one, sizeof(one));
}

bool WakeUp::wait(std::int64_t timeout_ns) {
  pollfd watched{.fd = descriptor_, .events = POLLIN, .revents = 0};
  const timespec timeout = to_timespec(timeout_ns < 0 ? 0 : timeout_ns);
  if (ppoll(&watched, 1, timeout_ns < 0 ? nullptr : &timeout, nullptr) <= 0) {
    return false;
  }
  std::uint64_t notifications = 0;
  return read(descriptor_, &notifications, sizeof(notifications)) == static_cast<ssize_t>(sizeof(notifications));
}

}  // namespace odoless
