#include "core/slam/particle_weights.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "core/base/check.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

void scale_to_sum_one(std::span<double> weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) {
    weight /= sum;
  }
}

}  // namespace

void normalise_weights(std::span<const double> log_weights, std::span<double> weights) {
  const double highest = *std::max_element(log_weights.begin(), log_weights.end());
  ODOLESS_CHECK(std::isfinite(highest));
  std::transform(log_weights.begin(), log_weights.end(), weights.begin(),
                 [highest](double log_weight) { return math::exp(log_weight - highest); });
  scale_to_sum_one(weights);
}

double effective_particles(std::span<const double> weights) {
  return 1.0 / std::inner_product(weights.begin(), weights.end(), weights.begin(), 0.0);
}

void systematic_copies(std::span<const double> weights, int wanted, double offset, std::span<int> copies) {
  double sum = 0.0;
  int given = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    copies[i] = 0;
    while (given < wanted && given + offset < sum * wanted) {
      ++copies[i];
      ++given;
    }
    last = weights[i] > 0.0 ? i : last;
  }
  copies[last] += wanted - given;  // the sum may fall short of 1 by rounding
}

void drop_weakest_half(std::span<double> weights, std::span<int> scratch) {
  std::iota(scratch.begin(), scratch.end(), 0);
  const auto weaker = [weights](int a, int b) {
    const double weight_a = weights[static_cast<std::size_t>(a)];
    const double weight_b = weights[static_cast<std::size_t>(b)];
    return weight_a < weight_b || (weight_a == weight_b && a > b);
  };
  const auto middle = scratch.begin() + static_cast<std::ptrdiff_t>(scratch.size() / 2);
  std::nth_element(scratch.begin(), middle, scratch.end(), weaker);
  for (auto i = scratch.begin(); i != middle; ++i) {
    weights[static_cast<std::size_t>(*i)] = 0.0;
  }
  scale_to_sum_one(weights);
}

}  // namespace odoless
