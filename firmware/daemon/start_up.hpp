#pragma once

#include <cstddef>
#include <string>

#include "firmware/daemon/daemon.hpp"

namespace odoless {

/// What a start lacks: for a person, with what would be right, and the exit status of sysexits.h for it. All of this is
/// found out before a device, a line or a socket is claimed.
struct Lack {
  int status = 0;  ///< 0: nothing
  std::string text{};
};

/// The system's words for an error number. Thread: that of the start.
[[nodiscard]] std::string reason_of(int error);

/// Standard input, output and error that are closed become /dev/null: the laser's line must not take their numbers, or
/// log lines would go to it.
void hold_standard_descriptors();

/// Where real time is required: which stage that runs here the configuration makes an ordinary thread; else an empty
/// text.
[[nodiscard]] std::string lack_of_priority(const DaemonOptions& options);

/// Files that can be opened besides, and a connection for each of that many browsers: 71 where there are too few.
[[nodiscard]] Lack lack_of_descriptors(int connections);

/// The folders for results and for the recorder: 73 where one cannot be written to.
[[nodiscard]] Lack lack_of_folders(const DaemonOptions& options);

/// Memory for what is not there from the start on, above all saving a map of `map_cells`: 71.
[[nodiscard]] Lack lack_of_memory(std::size_t map_cells);

/// That many threads: 71. They are made, and end.
[[nodiscard]] Lack lack_of_threads(int threads);

/// What this process may have of memory, where that is limited, for messages; else an empty text.
[[nodiscard]] std::string memory_limits_text();

}  // namespace odoless
