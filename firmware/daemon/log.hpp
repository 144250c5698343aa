#pragma once

#include <string_view>

#include "rt/event_ring.hpp"

namespace odoless {

/// One line of the log on standard error: with the journal's priority in front where the journal reads it, with the
/// program's name elsewhere. Thread: any ordinary one.
void log_line(EventPriority priority, std::string_view text);

/// Writes what a real-time thread has logged, and how many lines were lost.
void log_events(EventRing& events);

}  // namespace odoless
