#include "core/graph/world_thinning.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_set>
#include <utility>

#include "core/base/check.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kNear_m = 6.0;
constexpr double kSeen_share = 0.99;
constexpr double kCell_m = 0.25;

/// Ground as cells of 0.25 m, of parts of a world that lie on top of each other as well.
class Ground {
 public:
  explicit Ground(int part) : part_(part) {}

  /// What a keyframe saw within kNear_m, where no wall is in between.
  void see(const KeyframeStore& store, int keyframe, const Pose2& map_T_scan) {
    const Keyframe& of = store[keyframe];
    const std::span<const BeamCode> codes = store.codes(keyframe);
    const double step_rad = std::max(std::abs(of.angle_step_rad), 1e-4);
    const auto stride = static_cast<std::size_t>(std::max(1.0, kCell_m / kNear_m / step_rad));
    for (std::size_t i = 0; i < codes.size(); i += stride) {
      const double angle_rad = map_T_scan.yaw_rad + of.start_angle_rad + of.angle_step_rad * static_cast<double>(i);
      const Point2 direction{math::cos(angle_rad), math::sin(angle_rad)};
      const double reach_m = std::min(static_cast<double>(range_of(codes[i])), kNear_m);
      for (double way_m = 0.0; way_m < reach_m; way_m += 0.5 * kCell_m) {
        cells_.insert(key({map_T_scan.x_m + way_m * direction.x_m, map_T_scan.y_m + way_m * direction.y_m}));
      }
    }
  }

  void add(const Ground& other) { cells_.insert(other.cells_.begin(), other.cells_.end()); }

  /// Of this ground, what the other one has as well, or next to it: where a wall is at the edge of a cell, one visit
  /// has it and the other one has not.
  [[nodiscard]] double share_in(const Ground& other) const {
    const auto is_there = [&](std::int64_t cell) {
      for (const std::int64_t across : {-kRow, std::int64_t{0}, kRow}) {
        for (const std::int64_t along : {-1, 0, 1}) {
          if (other.cells_.contains(cell + across + along)) {
            return true;
          }
        }
      }
      return false;
    };
    const auto seen = std::count_if(cells_.begin(), cells_.end(), is_there);
    return cells_.empty() ? 0.0 : static_cast<double>(seen) / static_cast<double>(cells_.size());
  }

 private:
  static constexpr std::int64_t kRow = std::int64_t{1} << 20;  ///< 260 km
  static constexpr std::int64_t kPart = kRow * kRow;

  [[nodiscard]] std::int64_t key(const Point2& at) const {
    const auto column = static_cast<std::int64_t>(std::floor(at.x_m / kCell_m)) + kRow / 2;
    const auto row = static_cast<std::int64_t>(std::floor(at.y_m / kCell_m)) + kRow / 2;
    return part_ * kPart + row * kRow + column;
  }

  std::int64_t part_;
  std::unordered_set<std::int64_t> cells_;
};

Ground ground_of(const SubmapWorld& world, int submap) {
  const Submap& each = world.submaps[static_cast<std::size_t>(submap)];
  Ground ground(world.graph.component(submap));
  for (int k = each.first_keyframe; k < each.end_keyframe(); ++k) {
    ground.see(world.store, k, world.graph.pose(submap) * world.store.submap_T_scan(k));
  }
  return ground;
}

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

  void hand_over(int node) {
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
  }

  template <class Take>
  void for_each(const Take& take) const {
    for (const std::optional<Constraint>& each : all_) {
      if (each) {
        take(*each);
      }
    }
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

}  // namespace

std::vector<int> needless_submaps(const SubmapWorld& world) {
  std::vector<bool> is_tied(world.submaps.size(), false);  // to a newer one
  for (const Constraint& each : world.graph.constraints()) {
    const int older = std::min(each.from, each.to);
    is_tied[static_cast<std::size_t>(older)] = is_tied[static_cast<std::size_t>(older)] || is_tie_to_newer(each, older);
  }
  std::vector<int> needless;
  Ground seen(0);
  for (int i = static_cast<int>(world.submaps.size()) - 1; i >= 0; --i) {
    const Ground own = ground_of(world, i);
    if (is_tied[static_cast<std::size_t>(i)] && own.share_in(seen) >= kSeen_share) {
      needless.push_back(i);
    } else {
      seen.add(own);
    }
  }
  std::ranges::reverse(needless);
  return needless;
}

void copy_without(const SubmapWorld& world, const std::vector<int>& needless, KeyframeStore& store, PoseGraph& graph,
                  std::vector<Submap>& submaps) {
  constexpr int kGone = -1;
  Ties ties(world.graph);
  std::vector<int> number(world.submaps.size(), 0);
  for (const int each : needless) {  // the oldest first: the heirs are newer
    ties.hand_over(each);
    number[static_cast<std::size_t>(each)] = kGone;
  }
  std::optional<OdometryStretch> left_out;  // since the last keyframe that stays on the same path
  for (int i = 0; i < world.graph.size(); ++i) {
    const bool stays = number[static_cast<std::size_t>(i)] != kGone;
    Submap submap = world.submaps[static_cast<std::size_t>(i)];
    const int first = store.size();
    for (int k = submap.first_keyframe; k < submap.end_keyframe(); ++k) {
      Keyframe keyframe = world.store[k];
      left_out = goes_on(world.store, k) ? left_out : std::nullopt;
      keyframe.since_last = left_out ? left_out->then(keyframe.since_last) : keyframe.since_last;
      left_out = stays ? std::nullopt : std::optional(keyframe.since_last);
      if (stays) {
        store.place(store.add(keyframe, world.store.codes(k)), world.store.submap_T_scan(k));
      }
    }
    if (stays) {
      submap.first_keyframe = first;
      number[static_cast<std::size_t>(i)] = graph.add_node(world.graph.pose(i));
      submaps.push_back(submap);
    }
  }
  ties.for_each([&](Constraint each) {
    each.from = number[static_cast<std::size_t>(each.from)];
    each.to = number[static_cast<std::size_t>(each.to)];
    graph.add(each);
  });
}

}  // namespace odoless
