#include "drivers/tilt/tilt_line.hpp"

#include <cerrno>
#include <cstring>

#include "drivers/io/serial_port.hpp"
#include "drivers/io/socket_can.hpp"
#include "drivers/tilt/cia402/cia402_session.hpp"
#include "drivers/tilt/dynamixel/dynamixel_session.hpp"
#include "drivers/tilt/maestro/maestro_session.hpp"

namespace odoless {
namespace {

/// What the node says, and SYNC, which its measurements hang on.
std::array<CanFilter, 6> filters_of(int node) {
  const auto id = static_cast<std::uint32_t>(node);
  return {{{.id = canopen::kSyncCob},
           {.id = canopen::kEmergencyCob + id},
           {.id = canopen::kTransmitPdo1Cob + id},
           {.id = canopen::kTransmitPdo2Cob + id},
           {.id = canopen::kSdoReplyCob + id},
           {.id = canopen::kHeartbeatCob + id}}};
}

}  // namespace

std::unique_ptr<TiltSession> make_tilt_session(const TiltParams& params) {
  ODOLESS_CHECK(parameters_in_range(params));
  switch (params.driver) {
    case TiltDriver::kCia402:
      return std::make_unique<Cia402Session>(params);
    case TiltDriver::kDynamixel:
      return std::make_unique<DynamixelSession>(params);
    case TiltDriver::kMaestro:
      return std::make_unique<MaestroSession>(params);
    case TiltDriver::kNone:
      break;
  }
  ODOLESS_CHECK(false);
  return nullptr;
}

Result<FileDescriptor> open_tilt_line(const TiltParams& params) {
  return params.driver == TiltDriver::kCia402 ? open_can(params.device, filters_of(params.id))
                                              : open_serial({.path = params.device, .baud = params.baud});
}

Result<TiltRead> read_tilt_line(TiltDriver driver, int descriptor, std::span<std::byte> buffer, const Clock& clock) {
  if (driver == TiltDriver::kCia402) {
    CanReceived received;
    if (const Errc error = read_can(descriptor, clock, received); error != Errc::kOk) {
      return error;
    }
    ODOLESS_CHECK(buffer.size() >= sizeof(CanFrame));
    std::memcpy(buffer.data(), &received.frame, sizeof(CanFrame));
    return TiltRead{buffer.first(sizeof(CanFrame)), received.stamp_ns};
  }
  const ssize_t size = ::read(descriptor, buffer.data(), buffer.size());
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) {
    return Errc::kNotYet;
  }
  if (size <= 0) {
    return Errc::kDeviceMissing;
  }
  return TiltRead{buffer.first(static_cast<std::size_t>(size)), clock.now_ns()};
}

Errc write_tilt_line(TiltDriver driver, int descriptor, std::span<const std::byte> frame) {
  if (driver == TiltDriver::kCia402) {
    const std::optional<CanFrame> can = to_can_frame(frame);
    return can ? write_can(descriptor, *can) : Errc::kFrameMalformed;
  }
  const ssize_t size = ::write(descriptor, frame.data(), frame.size());
  if (size == static_cast<ssize_t>(frame.size())) {
    return Errc::kOk;
  }
  return size >= 0 || errno == EAGAIN || errno == EINTR ? Errc::kCapacity : Errc::kDeviceMissing;
}

}  // namespace odoless
