#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/graph/pose_graph.hpp"

namespace odoless {

/// Which older submaps one may overlap by what the odometry may have drifted, the nearest first; those that it was
/// matched with already are left out until it is taken to lie elsewhere.
///
/// Thread: owned by one thread. Memory is fixed at construction, but for scratch.
class MatchPlan {
 public:
  struct Candidate {
    int reference = 0;
    int query = 0;
    double sd_m = 0.0;
    double sd_rad = 0.0;
    double order = 0.0;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of reference_T_query as projected
  };

  explicit MatchPlan(int submaps_max) { attempts_.reserve(static_cast<std::size_t>(submaps_max)); }

  /// So many submaps more have no match yet.
  void add_submaps(std::size_t count) { attempts_.resize(attempts_.size() + count); }
  /// Submaps have other numbers. @param now  Of each that there was; negative: it is no more.
  void renumber(std::span<const int> now);

  void clear();
  /// Appends the candidates of a submap. @param first_own  Submaps from there on are of the same run.
  /// @param sd_max_m  Largest deviation of where one lies.
  void append(const PoseGraph& graph, int query, int first_own, int most, double sd_max_m);
  /// The next one, which counts as matched from here on; none: all are done.
  [[nodiscard]] std::optional<Candidate> next(const PoseGraph& graph);

 private:
  struct Attempt {
    int reference = -1;
    Pose2 predicted{};  ///< reference_T_query at that time
    double sd_m = 0.0;
  };
  static constexpr std::size_t kAttempts = 48;  ///< older submaps that one is matched with in all
  struct Attempts {
    std::array<Attempt, kAttempts> each;
    std::size_t count = 0;
  };

  [[nodiscard]] bool is_worth_trying(const PoseGraph& graph, const Candidate& candidate) const;
  void note(const PoseGraph& graph, const Candidate& candidate);

  std::vector<Attempts> attempts_;  ///< per submap
  PoseGraph::Projection projection_;
  std::vector<Candidate> candidates_;
  std::size_t next_ = 0;
};

}  // namespace odoless
