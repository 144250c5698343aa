#pragma once

#include <cstddef>
#include <vector>

namespace odoless {

/// What a set of numbers looks like; all 0 when there is none. Same unit as the numbers.
struct Statistics {
  std::size_t count = 0;
  double mean = 0.0;
  double deviation = 0.0;  ///< standard deviation of the set (divisor n)
  double root_mean_square = 0.0;
  double median = 0.0;         ///< mean of the two in the middle when they are even in number
  double percentile_95 = 0.0;  ///< the smallest number that 95 % do not exceed
  double percentile_99 = 0.0;  ///< the smallest number that 99 % do not exceed
  double max = 0.0;
};

[[nodiscard]] Statistics summarise(std::vector<double> values);

}  // namespace odoless
