#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/base/result.hpp"
#include "drivers/io/can_frame.hpp"
#include "drivers/io/file_descriptor.hpp"
#include "rt/clock.hpp"

namespace odoless {

/// Lets a frame through whose id is `id` in the bits of `mask`.
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x7FFU | CanFrame::kExtendedFlag | CanFrame::kRemoteFlag;  ///< that very id of 11 bits
};

struct CanReceived {
  CanFrame frame;
  std::int64_t stamp_ns = 0;  ///< when the kernel got it, by the clock that read_can was given
};

/// Opens a raw socket on a CAN interface, non-blocking, with the kernel's time stamps. It hears the frames that a
/// filter lets through, own ones among them as soon as they are on the bus, and all error frames.
///
/// Errors: Errc::kDeviceMissing, kNotCan, kDeviceDenied, kDeviceFailed. An interface that is down is none.
/// Thread: an ordinary one.
[[nodiscard]] Result<FileDescriptor> open_can(const std::string& interface, std::span<const CanFilter> filters);

/// Takes one frame that waits. @param clock  Of the frame's stamp.
///
/// @return Errc::kOk; kNotYet: none waits; kLinkDown: the interface is down, the socket stays good; else: open anew.
/// Real time: one system call (recvmsg), no allocation.
[[nodiscard]] Errc read_can(int socket, const Clock& clock, CanReceived& received);

/// @return Errc::kOk; kCapacity: the queue is full, the frame is dropped; kLinkDown as above; else: open anew.
/// Real time: one system call (write), no allocation.
[[nodiscard]] Errc write_can(int socket, const CanFrame& frame);

}  // namespace odoless
