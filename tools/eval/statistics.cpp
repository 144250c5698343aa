#include "tools/eval/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {

Statistics summarise(std::vector<double> values) {
  Statistics result{.count = values.size()};
  if (values.empty()) {
    return result;
  }
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  for (const double value : values) {
    result.mean += value / n;
    result.root_mean_square += value * value / n;
  }
  for (const double value : values) {
    result.deviation += (value - result.mean) * (value - result.mean) / n;
  }
  result.root_mean_square = std::sqrt(result.root_mean_square);
  result.deviation = std::sqrt(result.deviation);
  result.median = (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2.0;
  result.percentile_95 = values[(values.size() * 95 + 99) / 100 - 1];
  result.percentile_99 = values[(values.size() * 99 + 99) / 100 - 1];
  result.max = values.back();
  return result;
}

}  // namespace odoless
