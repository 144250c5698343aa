#include "core/graph/world_thinning.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr double kSeen_share = 0.99;

/// Whether a keyframe goes on from the one before it; else another run begins with it.
bool goes_on(const KeyframeStore& store, int keyframe) {
  constexpr double kRounding_m = 1e-3;
  constexpr double kRounding_rad = 1e-3;
  return keyframe > 0 && are_within(store[keyframe - 1].odom_T_scan * store[keyframe].since_last.start_T_end,
                                    store[keyframe].odom_T_scan, kRounding_m, kRounding_rad);
}

int other_end(const Constraint& constraint, int node) {
  return constraint.from == node ? constraint.to : constraint.from;
}

bool is_tie_to_newer(const Constraint& constraint, int submap) {
  return constraint.is_loop && constraint.holds() && other_end(constraint, submap) > submap;
}

/// Covariance of from_T_to, whichever way the constraint has it.
Eigen::Matrix3d covariance_to(const Constraint& constraint, int to) {
  return constraint.to == to ? constraint.covariance : inverted(constraint.covariance, constraint.from_T_to);
}

/// The constraints of a world while nodes are taken out of it one after the other.
class Ties {
 public:
  explicit Ties(const PoseGraph& graph) : graph_(graph), of_node_(static_cast<std::size_t>(graph.size())) {
    for (const Constraint& each : graph.constraints()) {
      add(each);
    }
  }

  /// @return  The newer node that stands for it from now on.
  int hand_over(int node) {
    std::vector<Constraint> own;
    for (const std::size_t i : std::exchange(of(node), {})) {
      if (all_[i]) {
        own.push_back(*std::exchange(all_[i], std::nullopt));
      }
    }
    const Constraint* surest = nullptr;
    for (const Constraint& each : own) {
      if (is_tie_to_newer(each, node) && (surest == nullptr || each.covariance.trace() < surest->covariance.trace())) {
        surest = &each;
      }
    }
    ODOLESS_CHECK(surest != nullptr);
    const int heir = other_end(*surest, node);
    for (const Constraint& each : own) {
      if (each.holds() && other_end(each, node) != heir) {
        add_surer(through(*surest, heir, node, each));
      }
    }
    return heir;
  }

  /// What is left of them.
  [[nodiscard]] std::vector<Constraint> constraints() const {
    std::vector<Constraint> left;
    for (const std::optional<Constraint>& each : all_) {
      if (each) {
        left.push_back(*each);
      }
    }
    return left;
  }

 private:
  [[nodiscard]] std::vector<std::size_t>& of(int node) { return of_node_[static_cast<std::size_t>(node)]; }

  void add(const Constraint& constraint) {
    of(constraint.from).push_back(all_.size());
    of(constraint.to).push_back(all_.size());
    all_.emplace_back(constraint);
  }

  [[nodiscard]] Constraint through(const Constraint& tie, int heir, int node, const Constraint& each) const {
    const int far = other_end(each, node);
    const Eigen::Matrix3d of_far =
        carried(covariance_to(tie, node), graph_.between(node, far)) + covariance_to(each, far);
    const auto [from, to] = std::minmax(heir, far);
    return {.from = from,
            .to = to,
            .from_T_to = graph_.between(from, to),
            .covariance = to == far ? of_far : inverted(of_far, graph_.between(heir, far)),
            .is_loop = true,
            .weight = std::min(tie.weight, each.weight)};
  }

  void add_surer(const Constraint& constraint) {
    for (const std::size_t i : of(constraint.from)) {
      if (all_[i] && all_[i]->is_loop && other_end(*all_[i], constraint.from) == constraint.to) {
        if (all_[i]->holds() && all_[i]->covariance.trace() <= constraint.covariance.trace()) {
          return;
        }
        all_[i].reset();
      }
    }
    add(constraint);
  }

  const PoseGraph& graph_;
  std::vector<std::optional<Constraint>> all_;  ///< none: handed over
  std::vector<std::vector<std::size_t>> of_node_;
};

/// Takes out keyframes; of the way behind them the next one that stays knows.
void take_out(const std::vector<bool>& is_gone, KeyframeStore& store) {
  std::optional<OdometryStretch> left_out;  // since the last keyframe that stays on the same path
  for (int k = 0; k < store.size(); ++k) {
    left_out = goes_on(store, k) ? left_out : std::nullopt;
    const OdometryStretch since_last = left_out ? left_out->then(store[k].since_last) : store[k].since_last;
    if (is_gone[static_cast<std::size_t>(k)]) {
      left_out = since_last;
    } else {
      store.set_since_last(k, since_last);
      left_out = std::nullopt;
    }
  }
  store.erase(is_gone);
}

}  // namespace

WorldThinning::WorldThinning(const SubmapWorld& world)
    : is_tied_(world.submaps.size(), false), next_(static_cast<int>(world.submaps.size())) {
  for (const Constraint& each : world.graph.constraints()) {
    const int older = std::min(each.from, each.to);
    is_tied_[static_cast<std::size_t>(older)] =
        is_tied_[static_cast<std::size_t>(older)] || is_tie_to_newer(each, older);
  }
}

bool WorldThinning::work(const SubmapWorld& world) {
  if (next_ == 0) {
    return false;
  }
  --next_;
  const Submap& submap = world.submaps[static_cast<std::size_t>(next_)];
  SeenGround own;
  for (int k = submap.first_keyframe; k < submap.end_keyframe(); ++k) {
    own.see(world.graph.component(next_), world.store, k, world.graph.pose(next_) * world.store.submap_T_scan(k));
  }
  if (is_tied_[static_cast<std::size_t>(next_)] && own.share_in(seen_) >= kSeen_share) {
    needless_.insert(needless_.begin(), next_);
  } else {
    seen_.add(own);
  }
  return next_ > 0;
}

std::vector<int> needless_submaps(const SubmapWorld& world) {
  WorldThinning thinning(world);
  while (thinning.work(world)) {
  }
  return thinning.needless();
}

SubmapNumbers leave_out(const std::vector<int>& needless, KeyframeStore& store, PoseGraph& graph,
                        std::vector<Submap>& submaps) {
  Ties ties(graph);
  std::vector<int> stands_for(submaps.size());
  std::iota(stands_for.begin(), stands_for.end(), 0);
  std::vector<bool> is_gone(static_cast<std::size_t>(store.size()), false);
  for (const int each : needless) {  // the oldest first: the heirs are newer
    const auto at = static_cast<std::size_t>(each);
    stands_for[at] = ties.hand_over(each);
    std::fill_n(is_gone.begin() + submaps[at].first_keyframe, submaps[at].keyframes, true);
  }
  take_out(is_gone, store);
  const std::vector<Pose2> poses(graph.poses().begin(), graph.poses().end());
  std::vector<Submap> before = std::exchange(submaps, {});
  submaps.reserve(before.capacity());
  graph.clear();
  SubmapNumbers numbers(before.size());
  int keyframes = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (stands_for[i] == static_cast<int>(i)) {
      numbers.now[i] = graph.add_node(poses[i]);
      before[i].first_keyframe = keyframes;
      keyframes += before[i].keyframes;
      submaps.push_back(before[i]);
    }
  }
  for (std::size_t i = before.size(); i-- > 0;) {
    const auto heir = static_cast<std::size_t>(stands_for[i]);
    numbers.heir[i] = heir == i ? numbers.now[i] : numbers.heir[heir];
  }
  std::vector<Constraint> constraints = ties.constraints();
  for (Constraint& each : constraints) {
    each.from = numbers.now[static_cast<std::size_t>(each.from)];
    each.to = numbers.now[static_cast<std::size_t>(each.to)];
  }
  std::ranges::stable_sort(constraints, {}, [](const Constraint& each) { return std::max(each.from, each.to); });
  for (const Constraint& each : constraints) {
    graph.add(each);
  }
  return numbers;
}

}  // namespace odoless
