#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/check.hpp"
#include "core/base/deadline.hpp"
#include "core/base/parameters.hpp"
#include "core/base/rng.hpp"
#include "core/optimize/search_box.hpp"

namespace odoless {

/// How a mutant is made from the population [storn1997de; method 3].
enum class DeStrategy : std::uint8_t {
  kRand1Bin,           ///< a random member plus one difference
  kBest1Bin,           ///< the best member plus one difference
  kCurrentToBest1Bin,  ///< the member, moved towards the best, plus one difference
  kCurrentToRing1Bin,  ///< the member, moved towards the best of its ring neighbours, plus one difference
  kJde,                ///< rand/1/bin whose factor and rate adapt per member [brest2006jde; method 3]
};
inline constexpr const char* kDeStrategyNames[] = {"rand-1-bin", "best-1-bin", "current-to-best-1-bin",
                                                   "current-to-ring-1-bin", "jde"};

struct DeParams {
  int population = 80;
  DeStrategy strategy = DeStrategy::kCurrentToRing1Bin;
  double factor = 0.5;
  double crossover_rate = 0.9;
  int ring_neighbours = 5;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("population", self.population, Range{8, 1000}, "Size of the population (N).");
    visit.choice("strategy", self.strategy, std::span<const char* const>(kDeStrategyNames),
                 "Strategy by which mutants are made.");
    visit.value("factor", self.factor, Range{0.0, 2.0}, "Scale of the difference of two members (F).");
    visit.value("crossover_rate", self.crossover_rate, Range{0.0, 1.0},
                "Probability that a coordinate comes from the mutant (CR).");
    visit.value("ring_neighbours", self.ring_neighbours, Range{1, 100},
                "Number of ring neighbours on either side, for current-to-ring-1-bin.");
  }
};

/// One candidate.
struct DeMember {
  SearchPoint point{};
  double score = 0.0;  ///< more is better
  double factor = 0.5;
  double crossover_rate = 0.9;
};

/// Which bound ended a search.
enum class StopReason : std::uint8_t { kBudget, kDeadline };

/// Differential Evolution in a box, three dimensions, maximising [storn1997de; method 3].
///
/// Each trial that is not worse replaces its parent at once. Memory is fixed at construction.
/// Thread: owned by one thread. Real time: no allocation; exactly `evaluations` calls of the score, fewer at a deadline
/// (asked every 16 evaluations); the population always holds the best so far.
class DifferentialEvolution {
 public:
  explicit DifferentialEvolution(const DeParams& params);

  /// Empties the population and sets the box.
  void begin(const SearchBox& box);
  /// Offers a candidate: taken while there is room, then in place of the worst if better.
  void offer(const SearchPoint& point, double score);

  [[nodiscard]] std::span<DeMember> population() { return {members_.data(), static_cast<std::size_t>(size_)}; }
  [[nodiscard]] const SearchBox& box() const { return box_; }
  [[nodiscard]] const DeMember& best() const { return members_[static_cast<std::size_t>(best_)]; }
  /// To be called after members were changed through `population`.
  void find_best();

  /// Evolves for `evaluations` calls of `score(const SearchPoint&)`. The population must hold at least 4 members.
  template <class Score>
  StopReason evolve(Score&& score, int evaluations, const Deadline& deadline, Rng& rng) {
    ODOLESS_CHECK(size_ >= 4);
    for (int i = 0; i < evaluations; ++i) {
      if (i % 16 == 0 && deadline.expired()) {
        return StopReason::kDeadline;
      }
      DeMember trial = make_trial(next_, rng);
      trial.score = score(trial.point);
      accept(next_, trial);
      next_ = (next_ + 1) % size_;
    }
    return StopReason::kBudget;
  }

 private:
  [[nodiscard]] DeMember make_trial(int parent, Rng& rng) const;
  [[nodiscard]] const DeMember& member(int i) const { return members_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] int ring_best(int centre) const;
  [[nodiscard]] SearchPoint mutant_base(int parent, int random, double factor) const;
  void accept(int parent, const DeMember& trial);

  DeParams params_;
  SearchBox box_;
  std::vector<DeMember> members_;
  int size_ = 0;
  int best_ = 0;
  int next_ = 0;
};

}  // namespace odoless
