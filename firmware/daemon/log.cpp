#include "firmware/daemon/log.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "firmware/daemon/crash_report.hpp"

namespace odoless {
namespace {

const char* name_of(EventPriority priority) {
  switch (priority) {
    case EventPriority::kEmergency:
    case EventPriority::kAlert:
    case EventPriority::kCritical:
    case EventPriority::kError:
      return "error: ";
    case EventPriority::kWarning:
      return "warning: ";
    case EventPriority::kNotice:
    case EventPriority::kInfo:
    case EventPriority::kDebug:
      return "";
  }
  return "";
}

}  // namespace

void log_line(EventPriority priority, std::string_view text) {
  remember_log_line(text);
  static const bool to_journal = std::getenv("JOURNAL_STREAM") != nullptr;  // NOLINT(concurrency-mt-unsafe)
  if (to_journal) {
    fmt::print(stderr, "<{}>{}\n", static_cast<int>(priority), text);
  } else {
    fmt::print(stderr, "odolessd: {}{}\n", name_of(priority), text);
  }
}

void log_events(EventRing& events) {
  for (Event event; events.try_pop(event);) {
    log_line(event.priority, format(event));
  }
}

}  // namespace odoless
