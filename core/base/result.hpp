#pragma once

#include <utility>
#include <variant>

#include "core/base/check.hpp"

namespace odoless {

/// Reasons for a run-time failure in core, rt, drivers and firmware.
enum class Errc {
  kOk = 0,
  kTooManyBeams,   ///< a scan has more beams than the frame has room for
  kTooFewReturns,  ///< a scan has too few valid returns to be used
  kBadGeometry,    ///< angles or stamps that are not finite, or a step of zero
  kNoReference,    ///< a match was asked for before a reference was set
  kCapacity,       ///< a pool with a fixed capacity is full
  kBadAddress,     ///< an address or name that cannot be used
  kUnavailable,    ///< the network or a service of the system refuses
  kTooLong,        ///< a message is longer than allowed, or than the buffer
  kMalformed,      ///< a message doesn't follow its format
  kUnknownType,    ///< a message is of another type than expected
  kBadNumber,      ///< a number in a message is not finite, or out of its range

  kDeviceMissing,  ///< no such device, or it is unplugged
  kDeviceBusy,     ///< another process uses the device
  kDeviceDenied,   ///< this user may not use the device
  kDeviceFailed,   ///< the device could not be opened or set up
  kNotSerial,      ///< the path is no serial line
  kBaudRefused,    ///< the line cannot have that rate

  kFrameTooLong,      ///< a reply is longer than any that was asked for
  kFrameTruncated,    ///< a reply has too few lines or values
  kFrameMalformed,    ///< a reply has a byte, a line or a number that its protocol doesn't know
  kWrongSum,          ///< a check sum doesn't match
  kWrongEcho,         ///< a reply to something that wasn't asked
  kWrongCount,        ///< a scan has more or fewer beams than were asked for
  kImplausibleStamp,  ///< the device's own clock says what cannot be
  kDeviceStatus,      ///< the device answered with an error status
  kDeviceSilent,      ///< the device doesn't answer, or has stopped sending

  kNotYet,            ///< of that moment nothing is known yet
  kTooOld,            ///< of that moment nothing is known any more
  kGap,               ///< what is known lies too far around that moment
  kImplausibleAngle,  ///< an axis cannot have come to the angle that it tells
  kWrongDevice,       ///< the device is another one than configured
  kDeviceRestarted,   ///< the device has started anew
  kStalled,           ///< an axis doesn't move as it should
  kHomingFailed,      ///< an axis doesn't find its zero
  kBusOff,            ///< the controller has left the bus because of too many errors
  kLinkDown,          ///< the network interface is down
  kNotCan,            ///< the network interface is no CAN interface, or the system has no CAN
};

/// One sentence for a person.
[[nodiscard]] const char* describe(Errc error);

/// A value, or the reason why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}  // NOLINT(google-explicit-constructor): returned as a plain value
  Result(Errc error) : state_(error) { ODOLESS_CHECK(error != Errc::kOk); }  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(state_); }
  [[nodiscard]] Errc error() const { return ok() ? Errc::kOk : std::get<Errc>(state_); }
  [[nodiscard]] const T& value() const {
    ODOLESS_CHECK(ok());
    return *std::get_if<T>(&state_);
  }
  /// Moves the value out.
  [[nodiscard]] T take() {
    ODOLESS_CHECK(ok());
    return std::move(*std::get_if<T>(&state_));
  }

 private:
  std::variant<T, Errc> state_;
};

}  // namespace odoless
