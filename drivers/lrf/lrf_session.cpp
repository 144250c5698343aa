#include "drivers/lrf/lrf_session.hpp"

namespace odoless {

void LrfCounters::reject(Errc reason, LrfSink& sink) {
  ++rejected;
  sink.on_event({.type = LrfEventType::kRejected, .reason = reason});
}

}  // namespace odoless
