#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tools/emulate/emulated_lrf.hpp"

namespace odoless {

/// What a source of scans must know of the laser that it is for.
struct EmulatedLrfModel {
  std::string name;
  std::string product;
  std::int64_t period_ns = 0;  ///< from scan to scan
  double range_sd_m = 0.0;     ///< standard deviation of one range
};

/// All lasers that can be emulated, of every protocol.
[[nodiscard]] std::vector<EmulatedLrfModel> emulated_lrf_models();

/// The laser of that name, one of the above; `source` must outlive it and have its period.
[[nodiscard]] std::unique_ptr<EmulatedLrf> make_emulated_lrf(std::string_view name, EmulatedScans& source,
                                                             EmulatedLrfOptions options, std::int64_t now_ns);

}  // namespace odoless
