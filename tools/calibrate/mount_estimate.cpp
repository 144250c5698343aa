#include "tools/calibrate/mount_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/eval/stamp_lookup.hpp"

namespace odoless {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kTurned_min_rad = 30.0 * kRadPerDeg;
constexpr double kAgreement_min = 0.5;

std::optional<double> told_turn_rad(const MatchRow& row, const ReferencePoses& reference, const StampLookup& lookup) {
  constexpr double kTolerance_s = 0.02;
  const auto at = [&](int index, double stamp_s) -> std::optional<Pose2> {
    if (reference.has_stamps) {
      return lookup.nearest(stamp_s, kTolerance_s);
    }
    const auto i = static_cast<std::size_t>(index);
    return i < reference.poses.size() ? std::optional(reference.poses[i].pose) : std::nullopt;
  };
  const std::optional<Pose2> from = at(row.reference_index, row.reference_stamp_s);
  const std::optional<Pose2> to = at(row.index, row.stamp_s);
  return from && to ? std::optional(wrap_angle(to->yaw_rad - from->yaw_rad)) : std::nullopt;
}

Handedness::Verdict verdict_of(const Handedness& found) {
  if (found.turned_rad < kTurned_min_rad || std::abs(found.agreement) < kAgreement_min) {
    return Handedness::Verdict::kUnknown;
  }
  return found.agreement > 0.0 ? Handedness::Verdict::kRight : Handedness::Verdict::kSwapped;
}

/// Ranges of one beam in scans from different places.
struct BeamRanges {
  std::vector<float> returns_m;
  int others = 0;  ///< no returns among those

  [[nodiscard]] bool is_of_robot(const OwnSectorParams& params) {
    constexpr double kReturns_min = 0.9;
    const std::size_t size = returns_m.size();
    if (size == 0 || static_cast<double>(size) < kReturns_min * (static_cast<double>(size) + others)) {
      return false;
    }
    std::sort(returns_m.begin(), returns_m.end());
    const float low_m = returns_m[size / 10];
    const float high_m = returns_m[size - 1 - size / 10];
    return high_m <= params.range_max_m && high_m - low_m <= params.spread_max_m;
  }
};

/// Scans of which each was taken somewhere else than the one before.
class Places {
 public:
  Places(const ScanLog& log, std::span<const MatchRow> matches) {
    constexpr double kStep_m = 0.1;
    constexpr double kStep_rad = 5.0 * kRadPerDeg;
    double moved_m = 0.0;
    double moved_rad = 0.0;
    for (const MatchRow& row : matches) {
      const double step_m = std::hypot(row.reference_T_scan.x_m, row.reference_T_scan.y_m);
      const double step_rad = std::abs(row.reference_T_scan.yaw_rad);
      moved_m += step_m;
      moved_rad += step_rad;
      travel_m += step_m;
      turned_rad += step_rad;
      if (moved_m >= kStep_m || moved_rad >= kStep_rad) {
        scans.push_back(&log.scans[static_cast<std::size_t>(row.index)]);
        moved_m = 0.0;
        moved_rad = 0.0;
      }
    }
  }

  std::vector<const LogScan*> scans{};
  double travel_m = 0.0;
  double turned_rad = 0.0;
};

/// Runs of beams, with small holes in them closed; a beam more on each side, which sees the edge now and then.
std::vector<AngleSector> sectors_of(const std::vector<bool>& is_own, const LogScan& scan) {
  constexpr std::size_t kHole = 3;
  std::vector<AngleSector> sectors;
  const auto bearing_rad = [&](double beam) { return scan.start_angle_rad + beam * scan.angle_step_rad; };
  for (std::size_t first = 0; first < is_own.size(); ++first) {
    if (!is_own[first]) {
      continue;
    }
    std::size_t last = first;
    for (std::size_t i = first; i < is_own.size() && i <= last + kHole; ++i) {
      last = is_own[i] ? i : last;
    }
    const double one_rad = bearing_rad(static_cast<double>(first) - 1.0);
    const double other_rad = bearing_rad(static_cast<double>(last) + 1.0);
    sectors.push_back({std::min(one_rad, other_rad), std::max(one_rad, other_rad)});
    first = last;
  }
  return sectors;
}

}  // namespace

Handedness compare_turns(std::vector<MatchRow> matches, const ReferencePoses& reference) {
  constexpr double kTurn_min_rad = 1.0 * kRadPerDeg;
  const StampLookup lookup(reference.poses);
  Handedness found;
  double both = 0.0;
  double seen2 = 0.0;
  double told2 = 0.0;
  for (const MatchRow& row : matches) {
    const std::optional<double> told_rad = told_turn_rad(row, reference, lookup);
    if (!row.converged || !told_rad || std::abs(*told_rad) < kTurn_min_rad) {
      continue;
    }
    const double seen_rad = row.reference_T_scan.yaw_rad;
    found.turned_rad += std::abs(*told_rad);
    both += seen_rad * *told_rad;
    seen2 += seen_rad * seen_rad;
    told2 += *told_rad * *told_rad;
  }
  found.agreement = seen2 > 0.0 && told2 > 0.0 ? both / std::sqrt(seen2 * told2) : 0.0;
  found.verdict = verdict_of(found);
  found.matches = std::move(matches);
  return found;
}

Handedness compare_first_turn(std::vector<MatchRow> matches, bool was_left) {
  Handedness found;
  double yaw_rad = 0.0;
  for (const MatchRow& row : matches) {
    yaw_rad += row.converged ? row.reference_T_scan.yaw_rad : 0.0;
    if (std::abs(yaw_rad) >= kFirstTurn_rad) {
      found.turned_rad = std::abs(yaw_rad);
      found.agreement = (yaw_rad > 0.0) == was_left ? 1.0 : -1.0;
      break;
    }
  }
  found.verdict = verdict_of(found);
  found.matches = std::move(matches);
  return found;
}

OwnSectors find_own_sectors(const ScanLog& log, std::span<const MatchRow> matches, const ScanParams& scan,
                            const OwnSectorParams& params) {
  constexpr std::size_t kPlaces_min = 10;
  constexpr double kTravel_min_m = 2.0;
  const Places places(log, matches);
  OwnSectors found{.travel_m = places.travel_m, .turned_rad = places.turned_rad};
  found.is_told =
      places.scans.size() >= kPlaces_min && (places.travel_m >= kTravel_min_m || places.turned_rad >= std::numbers::pi);
  if (!found.is_told) {
    return found;
  }
  const LogScan& like = *places.scans.front();
  std::vector<BeamRanges> beams(like.ranges_m.size());
  for (const LogScan* const place : places.scans) {
    for (std::size_t i = 0; i < std::min(beams.size(), place->ranges_m.size()); ++i) {
      const float range_m = place->ranges_m[i];
      const bool is_return = range_m >= scan.range_min_m && range_m < place->no_return_m;  // false for NaN
      is_return ? beams[i].returns_m.push_back(range_m) : static_cast<void>(++beams[i].others);
    }
  }
  std::vector<bool> is_own(beams.size());
  std::transform(beams.begin(), beams.end(), is_own.begin(), [&](BeamRanges& b) { return b.is_of_robot(params); });
  found.sectors = sectors_of(is_own, like);
  return found;
}

std::vector<AngleSector> sectors_on(std::span<const AngleSector> sectors, const LaserPlace& laser) {
  constexpr double kAlmost = 1e-6;  // a whole degree that was rounded stays one
  std::vector<AngleSector> out;
  for (const AngleSector& sector : sectors) {
    const double one_rad = laser.bearing_rad(sector.from_rad);
    const double other_rad = laser.bearing_rad(sector.to_rad);
    out.push_back({std::floor(std::min(one_rad, other_rad) / kRadPerDeg + kAlmost) * kRadPerDeg,
                   std::ceil(std::max(one_rad, other_rad) / kRadPerDeg - kAlmost) * kRadPerDeg});
  }
  return out;
}

}  // namespace odoless
