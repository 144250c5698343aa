#include "tools/eval/pairs.hpp"

#include <algorithm>

namespace odoless {
namespace {

constexpr std::size_t kWorstShown = 5;

/// Where the reference sees a scan.
class ReferenceLookup {
 public:
  ReferenceLookup(const ReferencePoses& reference, double tolerance_s)
      : reference_(reference), by_stamp_(reference.poses), tolerance_s_(tolerance_s) {}

  [[nodiscard]] std::optional<Pose2> find(int index, double stamp_s) const {
    if (reference_.has_stamps) {
      return by_stamp_.nearest(stamp_s, tolerance_s_);
    }
    const auto i = static_cast<std::size_t>(index);
    return i < reference_.poses.size() ? std::optional(reference_.poses[i].pose) : std::nullopt;
  }

 private:
  const ReferencePoses& reference_;
  StampLookup by_stamp_;
  double tolerance_s_;
};

/// How many times over the limits of a gross failure.
double severity(const PoseError& error, const PairsParams& params) {
  return std::max(error.translation_m / params.gross_translation_m, error.rotation_rad / params.gross_rotation_rad);
}

std::vector<PairError> compare(const ReferencePoses& reference, std::span<const MatchRow> rows,
                               const Association& association) {
  const ReferenceLookup lookup(reference, association.tolerance_s);
  std::vector<PairError> errors;
  for (const MatchRow& row : rows) {
    const auto world_T_reference = lookup.find(row.reference_index, row.reference_stamp_s);
    const auto world_T_scan = lookup.find(row.index, row.stamp_s);
    if (world_T_reference && world_T_scan) {
      errors.push_back({row, pose_error(world_T_reference->inverse() * *world_T_scan,
                                        robot_motion(row.reference_T_scan, association.laser_x_m))});
    }
  }
  return errors;
}

PoseErrorStatistics summarise_pairs(std::span<const PairError> pairs) {
  std::vector<PoseError> errors;
  for (const PairError& pair : pairs) {
    errors.push_back(pair.error);
  }
  return summarise(errors);
}

void add_row_statistics(std::span<const MatchRow> rows, PairsResult& result) {
  std::vector<double> times_us;
  double converged = 0.0;
  for (const MatchRow& row : rows) {
    times_us.push_back(row.time_us);
    converged += row.converged ? 1.0 : 0.0;
  }
  result.time_us = summarise(std::move(times_us));
  result.converged_share = rows.empty() ? 0.0 : converged / static_cast<double>(rows.size());
}

}  // namespace

PairsResult evaluate_pairs(const ReferencePoses& reference, std::span<const MatchRow> rows, const PairsParams& params) {
  PairsResult result;
  add_row_statistics(rows, result);
  std::vector<PairError> pairs = compare(reference, rows, params.association);
  result.used = pairs.size();
  result.missing = rows.size() - pairs.size();
  result.errors = summarise_pairs(pairs);
  std::stable_sort(pairs.begin(), pairs.end(), [&](const PairError& a, const PairError& b) {
    return severity(a.error, params) > severity(b.error, params);
  });
  result.gross = static_cast<std::size_t>(std::count_if(
      pairs.begin(), pairs.end(), [&](const PairError& pair) { return severity(pair.error, params) > 1.0; }));
  result.errors_of_good = summarise_pairs(std::span(pairs).subspan(result.gross));
  pairs.resize(std::min(pairs.size(), kWorstShown));
  result.worst = std::move(pairs);
  return result;
}

}  // namespace odoless
