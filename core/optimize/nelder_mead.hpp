#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "core/base/deadline.hpp"
#include "core/optimize/search_box.hpp"

namespace odoless {

/// A point with its score.
struct ScoredPoint {
  SearchPoint point{};
  double score = 0.0;  ///< more is better
};

/// Downhill simplex [nelder1965simplex; method 3], maximising in three dimensions.
///
/// Starts from `start` and three points at `size` along the axes; `evaluations` calls of `score(const
/// SearchPoint&)`, up to 4 more where the last step needs them, and at least 3. Fewer at a deadline, which is asked
/// every 8 steps of at most 5 calls, the first time before the first step. Real time: no allocation.
template <class Score>
ScoredPoint nelder_mead(const ScoredPoint& start, const SearchPoint& size, int evaluations, Score&& score,
                        const Deadline& deadline = {}) {
  constexpr std::size_t kCorners = 4;
  std::array<ScoredPoint, kCorners> simplex;
  simplex.fill(start);
  for (std::size_t k = 0; k < 3; ++k) {
    simplex[k + 1].point[k] += size[k];
    simplex[k + 1].score = score(simplex[k + 1].point);
  }
  const auto order = [&] {  // insertion sort, best first: four entries
    for (std::size_t i = 1; i < kCorners; ++i) {
      for (std::size_t j = i; j > 0 && simplex[j].score > simplex[j - 1].score; --j) {
        std::swap(simplex[j], simplex[j - 1]);
      }
    }
  };
  for (int used = 3, step = 0; used < evaluations; ++step) {
    if (step % 8 == 0 && deadline.expired()) {
      break;
    }
    order();
    const auto along = [&](double factor) {  // on the line from the worst corner through the centre of the others
      ScoredPoint p;
      for (std::size_t k = 0; k < 3; ++k) {
        const double centre = (simplex[0].point[k] + simplex[1].point[k] + simplex[2].point[k]) / 3.0;
        p.point[k] = centre + factor * (centre - simplex[3].point[k]);
      }
      p.score = score(p.point);
      ++used;
      return p;
    };
    const ScoredPoint reflected = along(1.0);
    if (reflected.score > simplex[0].score) {
      const ScoredPoint expanded = along(2.0);
      simplex[3] = expanded.score > reflected.score ? expanded : reflected;
    } else if (reflected.score > simplex[2].score) {
      simplex[3] = reflected;
    } else {
      const ScoredPoint contracted = along(reflected.score > simplex[3].score ? 0.5 : -0.5);
      if (contracted.score > simplex[3].score) {
        simplex[3] = contracted;
        continue;
      }
      for (std::size_t i = 1; i < kCorners; ++i, ++used) {
        for (std::size_t k = 0; k < 3; ++k) {
          simplex[i].point[k] = 0.5 * (simplex[i].point[k] + simplex[0].point[k]);
        }
        simplex[i].score = score(simplex[i].point);
      }
    }
  }
  order();
  return simplex[0];
}

}  // namespace odoless
