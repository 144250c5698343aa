#include "drivers/io/socket_can.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <ctime>
#include <limits>

namespace odoless {
namespace {

static_assert(sizeof(CanFrame) == sizeof(can_frame) && offsetof(CanFrame, data) == offsetof(can_frame, data));
static_assert(CanFrame::kErrorFlag == CAN_ERR_FLAG && CanFrame::kRemoteFlag == CAN_RTR_FLAG &&
              CanFrame::kExtendedFlag == CAN_EFF_FLAG);

constexpr std::size_t kFiltersMax = 16;
constexpr std::int64_t kStampAgeMaxNs = 1'000'000'000;

Errc error_of(int error_number) {
  switch (error_number) {
    case EAGAIN:
    case EINTR:
      return Errc::kNotYet;
    case ENOBUFS:
      return Errc::kCapacity;
    case ENETDOWN:
      return Errc::kLinkDown;
    case ENODEV:
    case ENXIO:
      return Errc::kDeviceMissing;
    case EACCES:
    case EPERM:
      return Errc::kDeviceDenied;
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
      return Errc::kNotCan;
    default:
      return Errc::kDeviceFailed;
  }
}

template <class Value>
bool set_option(int socket, int level, int name, const Value& value) {
  return ::setsockopt(socket, level, name, &value, sizeof(value)) == 0;
}

bool set_options(int socket, std::span<const CanFilter> filters) {
  std::array<can_filter, kFiltersMax> kernel_filters{};
  const std::size_t count = std::min(filters.size(), kFiltersMax);
  std::transform(filters.begin(), filters.begin() + static_cast<std::ptrdiff_t>(count), kernel_filters.begin(),
                 [](const CanFilter& filter) { return can_filter{.can_id = filter.id, .can_mask = filter.mask}; });
  const auto filters_bytes = static_cast<socklen_t>(count * sizeof(can_filter));
  return ::setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FILTER, kernel_filters.data(), filters_bytes) == 0 &&
         set_option(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, can_err_mask_t{CAN_ERR_MASK}) &&
         set_option(socket, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, int{1}) &&
         set_option(socket, SOL_SOCKET, SO_TIMESTAMPNS, int{1});
}

std::int64_t to_ns(const timespec& time) { return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec; }

/// The same moment by two clocks.
struct Moment {
  std::int64_t clock_ns = 0;
  std::int64_t wall_ns = 0;
};

/// Both clocks at once: of some attempts that one which nothing came between.
Moment now(const Clock& clock) {
  constexpr int kAttempts = 3;
  Moment now;
  std::int64_t shortest_ns = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < kAttempts; ++i) {
    timespec wall{};
    const std::int64_t before_ns = clock.now_ns();
    static_cast<void>(clock_gettime(CLOCK_REALTIME, &wall));
    const std::int64_t took_ns = clock.now_ns() - before_ns;
    if (took_ns < shortest_ns) {
      shortest_ns = took_ns;
      now = {before_ns + took_ns / 2, to_ns(wall)};
    }
  }
  return now;
}

/// The kernel's stamp is on the wall clock; how long ago it was holds on every clock, unless that was set meanwhile.
std::int64_t stamp_ns(msghdr& message, const Clock& clock) {
  for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr; header = CMSG_NXTHDR(&message, header)) {
    if (header->cmsg_level == SOL_SOCKET && header->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(header), sizeof(stamp));
      const auto [clock_ns, wall_ns] = now(clock);
      const std::int64_t age_ns = wall_ns - to_ns(stamp);
      return age_ns >= 0 && age_ns <= kStampAgeMaxNs ? clock_ns - age_ns : clock_ns;
    }
  }
  return clock.now_ns();
}

}  // namespace

Result<FileDescriptor> open_can(const std::string& interface, std::span<const CanFilter> filters) {
  FileDescriptor can(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!can.valid()) {
    return error_of(errno);
  }
  ifreq request{};
  if (interface.empty() || interface.size() >= sizeof(request.ifr_name)) {
    return Errc::kDeviceMissing;
  }
  // NOLINTBEGIN(cppcoreguidelines-pro-type-union-access): the kernel's interface
  std::copy(interface.begin(), interface.end(), request.ifr_name);
  if (::ioctl(can.get(), SIOCGIFHWADDR, &request) != 0) {
    return error_of(errno);
  }
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN) {
    return Errc::kNotCan;
  }
  if (::ioctl(can.get(), SIOCGIFINDEX, &request) != 0) {
    return error_of(errno);
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  // NOLINTEND(cppcoreguidelines-pro-type-union-access)
  const bool is_set = set_options(can.get(), filters);
  if (!is_set || ::bind(can.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return error_of(errno);
  }
  return can;
}

Errc read_can(int socket, const Clock& clock, CanReceived& received) {
  alignas(cmsghdr) std::array<char, 128> control{};
  iovec part{.iov_base = &received.frame, .iov_len = sizeof(received.frame)};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = ::recvmsg(socket, &message, 0);
  if (size < 0) {
    return error_of(errno);
  }
  received.stamp_ns = stamp_ns(message, clock);
  return size == sizeof(received.frame) ? Errc::kOk : Errc::kDeviceFailed;
}

Errc write_can(int socket, const CanFrame& frame) {
  const ssize_t size = ::write(socket, &frame, sizeof(frame));
  if (size == sizeof(frame)) {
    return Errc::kOk;
  }
  const Errc error = size < 0 ? error_of(errno) : Errc::kDeviceFailed;
  return error == Errc::kNotYet ? Errc::kCapacity : error;
}

}  // namespace odoless
