#pragma once

#include <string>

#include "core/scan/scan_frame.hpp"

namespace odoless {

/// Two scans about 1 s apart, on which the matcher's speed is measured.
struct BenchPair {
  ScanFrame reference;
  ScanFrame scan;
  std::string label;  ///< where they come from
};

/// The first two of the recorded log fr079 (360 beams), or of a simulated room where there is no log; read once.
[[nodiscard]] const BenchPair& bench_pair();

}  // namespace odoless
