#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace odoless {

/// Sorts what is nearly in order, by carrying each value that isn't back to its place: a comparison per value and a
/// step per value that it passes. Values in whatever order take n log n, as std::sort does: it takes over after
/// `kStepsPerValue` steps per value. Real time: no allocation.
template <class Value, class Less>
void sort_nearly_sorted(std::span<Value> values, const Less& less) {
  constexpr std::size_t kStepsPerValue = 8;
  std::size_t steps = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!less(values[i], values[i - 1])) {
      continue;
    }
    const Value value = values[i];
    std::size_t place = i;
    for (; place > 0 && less(value, values[place - 1]); --place) {
      values[place] = values[place - 1];
    }
    values[place] = value;
    steps += i - place;
    if (steps > kStepsPerValue * values.size()) {
      std::sort(values.begin(), values.end(), less);
      return;
    }
  }
}

}  // namespace odoless
