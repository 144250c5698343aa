#pragma once

#include <fmt/core.h>

#include <cstdio>

namespace odoless::test {

/// A figure for the fault matrix (tests/faults): what was measured of a row's promise, such as "flag" or "recover".
inline void measured(int row, const char* what, double value, const char* unit) {
  fmt::print("fault matrix: row {}: {} {:.4f} {}\n", row, what, value, unit);
  static_cast<void>(std::fflush(stdout));
}

}  // namespace odoless::test
