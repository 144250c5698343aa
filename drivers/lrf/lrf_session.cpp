#include "drivers/lrf/lrf_session.hpp"

namespace odoless {

void LrfCounters::reject(Errc reason, LrfSink& sink) {
  ++rejected;
  wrong_sums += reason == Errc::kWrongSum ? 1 : 0;
  wrong_counts += reason == Errc::kWrongCount || reason == Errc::kFrameTruncated ? 1 : 0;
  implausible += reason == Errc::kImplausibleStamp ? 1 : 0;
  sink.on_event({.type = LrfEventType::kRejected, .reason = reason});
}

}  // namespace odoless
