#pragma once

#include <string>

#include "core/base/parameters.hpp"

namespace odoless {

/// Where all messages are recorded, and how much of the disk that may take.
struct LogWriterParams {
  std::string path;
  int file_max_mb = 100;
  int total_max_mb = 1000;
  double sync_s = 1.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("path", self.path,
               "Path of the recording; files PATH.00000.lcm, PATH.00001.lcm and so on are written; empty: none.");
    visit.value("file_max_mb", self.file_max_mb, Range{1, 100'000}, "Size at which the next file begins.");
    visit.value("total_max_mb", self.total_max_mb, Range{1, 10'000'000},
                "Size of all these files together, also those of earlier runs: the oldest are deleted before a new one "
                "would exceed it.");
    visit.value("sync_s", self.sync_s, Range{0.1, 3600.0},
                "Period in which the recording is written through to the disk; a power cut loses at most this.");
  }
};

}  // namespace odoless
