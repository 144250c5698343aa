#include "core/optimize/search_box.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace odoless {
namespace {

double radical_inverse(int index, int base) {
  double inverse = 0.0;
  double digit_weight = 1.0 / base;
  for (; index > 0; index /= base) {
    inverse += digit_weight * (index % base);
    digit_weight /= base;
  }
  return inverse;
}

}  // namespace

void SearchBox::reflect(SearchPoint& point) const {
  for (std::size_t i = 0; i < point.size(); ++i) {
    const double h = half_size[i];
    const double offset = point[i] - centre[i];
    if (std::abs(offset) > h) {
      point[i] = centre[i] + std::clamp(std::copysign(2.0 * h, offset) - offset, -h, h);
    }
  }
}

bool SearchBox::holds(const SearchPoint& point) const {
  constexpr double kRounding = 1e-9;  // of a point on a wall
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (std::abs(point[i] - centre[i]) > half_size[i] + kRounding) {
      return false;
    }
  }
  return true;
}

SearchPoint SearchBox::at(const SearchPoint& fractions) const {
  SearchPoint point{};
  for (std::size_t i = 0; i < point.size(); ++i) {
    point[i] = centre[i] + (2.0 * fractions[i] - 1.0) * half_size[i];
  }
  return point;
}

SearchPoint halton(int index) {
  return {radical_inverse(index + 1, 2), radical_inverse(index + 1, 3), radical_inverse(index + 1, 5)};
}

}  // namespace odoless
