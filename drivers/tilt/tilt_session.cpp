#include "drivers/tilt/tilt_session.hpp"

namespace odoless {

void TiltCounters::reject(Errc reason, TiltSink& sink) {
  ++rejected;
  wrong_sums += reason == Errc::kWrongSum ? 1 : 0;
  wrong_echoes += reason == Errc::kWrongEcho ? 1 : 0;
  implausible += reason == Errc::kImplausibleAngle ? 1 : 0;
  sink.on_event({.type = TiltEventType::kRejected, .reason = reason});
}

void TiltCounters::tell_device_error(TiltError error, std::int64_t code, TiltSink& sink, std::uint32_t object) {
  ++device_errors;
  sink.on_event({.type = TiltEventType::kDeviceError,
                 .reason = Errc::kDeviceStatus,
                 .error = error,
                 .code = code,
                 .object = object});
}

}  // namespace odoless
