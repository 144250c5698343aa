#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/scan_span.hpp"
#include "core/match/global_search.hpp"
#include "core/slam/recovery_params.hpp"
#include "core/slam/scan_fit.hpp"
#include "core/slam/slam.hpp"

namespace odoless {

/// Finds a lost robot in its own map: a global search for one scan, in slices, then a trial of what it found against
/// the scans that follow, moved on by the odometry. The robot is found when one candidate alone explains them; twins,
/// as in a symmetric room, leave it lost until it sees what tells them apart.
///
/// Thread:    owned by one thread, which calls it once per scan while lost, and maps nothing meanwhile.
/// Real time: no allocation after construction; a scan's slice is bounded by its share of `evaluations_per_s` and the
///            number of candidates.
class Relocaliser {
 public:
  Relocaliser(const RelocaliserParams& params, double fit_sigma_m, const ScanParams& scan, const Slam& slam);

  /// From here on nothing is known but the map, and perhaps where the robot is taken to be.
  /// @param fit_min  What a candidate must fit in it, if that is more than `found_fit`.
  void begin(Slam& slam, double fit_min);
  /// The robot's motion by the odometry, whether with a scan or not.
  void move(const Pose2& previous_T_current);
  /// @param believed_map_T_scan  Where tracking has the robot, if it has not lost it: one candidate more.
  /// @return                     map_T_scan once it is found.
  [[nodiscard]] std::optional<Pose2> process(Slam& slam, const ScanFrame& scan,
                                             const std::optional<Pose2>& believed_map_T_scan);

  /// The candidates that are on trial.
  [[nodiscard]] int candidates() const { return static_cast<int>(trial_count_); }

 private:
  struct Candidate {
    Pose2 map_T_scan;
    double fit_sum = 0.0;
    double known_sum = 0.0;     ///< of the shares of beams that the map says anything of
    double in_known_sum = 0.0;  ///< of the fits of these
  };

  void start_trial(const std::optional<Pose2>& believed_map_T_scan);
  void try_scan(Slam& slam, const ScanFrame& scan);
  void drop_doubles();
  /// Whether another candidate may as well be where the robot is.
  [[nodiscard]] bool has_rival() const;
  [[nodiscard]] std::optional<Pose2> verdict();
  [[nodiscard]] std::span<Candidate> candidates_on_trial() { return std::span(trial_).first(trial_count_); }

  RelocaliserParams params_;
  ScanFit fit_;
  GlobalSearch search_;
  PointSet points_;
  std::vector<Candidate> trial_;
  std::size_t trial_count_ = 0;
  double fit_min_ = 0.0;
  Pose2 searched_T_scan_{};  ///< motion since the scan that is searched for
  int trial_scans_ = 0;
  double trial_s_ = 0.0;
  ScanSpan span_;
};

}  // namespace odoless
