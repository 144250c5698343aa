#include "core/optimize/differential_evolution.hpp"

namespace odoless {

DifferentialEvolution::DifferentialEvolution(const DeParams& params) : params_(params) {
  ODOLESS_CHECK(parameters_in_range(params));
  members_.resize(static_cast<std::size_t>(params.population));
}

void DifferentialEvolution::begin(const SearchBox& box) {
  box_ = box;
  size_ = 0;
  best_ = 0;
  next_ = 0;
}

void DifferentialEvolution::offer(const SearchPoint& point, double score) {
  const DeMember candidate{point, score, params_.factor, params_.crossover_rate};
  if (size_ < params_.population) {
    members_[static_cast<std::size_t>(size_++)] = candidate;
  } else {
    const auto worst = std::min_element(members_.begin(), members_.end(),
                                        [](const DeMember& a, const DeMember& b) { return a.score < b.score; });
    if (score <= worst->score) {
      return;
    }
    *worst = candidate;
  }
  find_best();
}

void DifferentialEvolution::find_best() {
  best_ = 0;
  for (int i = 1; i < size_; ++i) {
    best_ = member(i).score > member(best_).score ? i : best_;
  }
}

int DifferentialEvolution::ring_best(int centre) const {
  int best = centre;
  for (int offset = -params_.ring_neighbours; offset <= params_.ring_neighbours; ++offset) {
    const int i = ((centre + offset) % size_ + size_) % size_;
    best = member(i).score > member(best).score ? i : best;
  }
  return best;
}

SearchPoint DifferentialEvolution::mutant_base(int parent, int random, double factor) const {
  int towards = parent;
  switch (params_.strategy) {
    case DeStrategy::kRand1Bin:
    case DeStrategy::kJde:
      return member(random).point;
    case DeStrategy::kBest1Bin:
      return member(best_).point;
    case DeStrategy::kCurrentToBest1Bin:
      towards = best_;
      break;
    case DeStrategy::kCurrentToRing1Bin:
      towards = ring_best(parent);
      break;
  }
  SearchPoint base = member(parent).point;
  for (std::size_t k = 0; k < base.size(); ++k) {
    base[k] += factor * (member(towards).point[k] - base[k]);
  }
  return base;
}

DeMember DifferentialEvolution::make_trial(int parent, Rng& rng) const {
  DeMember trial = member(parent);
  if (params_.strategy == DeStrategy::kJde) {
    trial.factor = rng.uniform() < 0.1 ? rng.uniform(0.1, 1.0) : trial.factor;
    trial.crossover_rate = rng.uniform() < 0.1 ? rng.uniform() : trial.crossover_rate;
  }
  const auto count = static_cast<std::uint32_t>(size_);
  const int random = static_cast<int>(rng.below(count));
  const SearchPoint& a = member(static_cast<int>(rng.below(count))).point;
  const SearchPoint& b = member(static_cast<int>(rng.below(count))).point;
  const SearchPoint base = mutant_base(parent, random, trial.factor);
  const std::size_t always = rng.below(3);  // one coordinate always comes from the mutant
  for (std::size_t k = 0; k < trial.point.size(); ++k) {
    if (k == always || rng.uniform() < trial.crossover_rate) {
      trial.point[k] = base[k] + trial.factor * (a[k] - b[k]);
    }
  }
  box_.reflect(trial.point);
  return trial;
}

void DifferentialEvolution::accept(int parent, const DeMember& trial) {
  if (trial.score >= member(parent).score) {
    members_[static_cast<std::size_t>(parent)] = trial;
    best_ = trial.score > member(best_).score ? parent : best_;
  }
}

}  // namespace odoless
