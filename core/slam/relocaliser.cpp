#include "core/slam/relocaliser.hpp"

#include <algorithm>

namespace odoless {
namespace {

constexpr int kClimb_steps = 40;  // from scan to scan, after the odometry's motion
constexpr int kReturns_min = 30;
constexpr int kTrial_scans_min = 5;
constexpr double kRival_known = 0.5;  // share of beams that the map says anything of, for a pose to be a rival

/// The map that the filter would write, whichever level's it is.
class SlamSquares final : public MapSquares {
 public:
  explicit SlamSquares(Slam& slam) : slam_(slam) {}
  [[nodiscard]] GridGeometry geometry() const override { return slam_.map_geometry(); }
  [[nodiscard]] bool read(GridCell corner, Square& percent) override {
    return slam_.write_square(corner, kSide_cells, percent);
  }

 private:
  Slam& slam_;
};

}  // namespace

Relocaliser::Relocaliser(const RelocaliserParams& params, double fit_sigma_m, const ScanParams& scan, const Slam& slam)
    : params_(params),
      fit_(slam.params().low.beam, fit_sigma_m, slam.map_geometry().resolution_m, slam.params().low.beams_used),
      search_(params.global, slam.map_geometry(), scan.beams_max),
      points_(scan.beams_max),
      trial_(static_cast<std::size_t>(params.global.candidates) + 1) {
  ODOLESS_CHECK(parameters_in_range(params));
}

void Relocaliser::begin(Slam& slam, double fit_min) {
  fit_min_ = std::max(params_.found_fit, fit_min);
  const Pose2 last_map_T_scan = slam.map_T_scan();
  search_.forget_map({last_map_T_scan.x_m, last_map_T_scan.y_m}, slam.map_geometry().centre_m());
  trial_count_ = 0;
}

void Relocaliser::move(const Pose2& previous_T_current) {
  searched_T_scan_ = searched_T_scan_ * previous_T_current;
  for (Candidate& candidate : candidates_on_trial()) {
    candidate.map_T_scan = candidate.map_T_scan * previous_T_current;
  }
}

std::optional<Pose2> Relocaliser::process(Slam& slam, const ScanFrame& scan,
                                          const std::optional<Pose2>& believed_map_T_scan) {
  const double span_s = span_.next_s(scan.stamp_ns());
  if (scan.returns() < kReturns_min) {
    return std::nullopt;
  }
  if (trial_count_ > 0) {
    trial_s_ += span_s;
    try_scan(slam, scan);
    return verdict();
  }
  if (search_.has_map() && (search_.is_idle() || search_.is_done())) {
    search_.begin(scan);
    searched_T_scan_ = Pose2{};
  }
  SlamSquares map(slam);
  static_cast<void>(search_.work(map, static_cast<int>(params_.evaluations_per_s * span_s)));
  if (search_.is_done()) {
    start_trial(believed_map_T_scan);
  }
  return std::nullopt;
}

void Relocaliser::start_trial(const std::optional<Pose2>& believed_map_T_scan) {
  trial_count_ = 0;
  if (believed_map_T_scan) {
    trial_[trial_count_++] = {*believed_map_T_scan};
  }
  for (const ScoredPoint& found : search_.found()) {
    trial_[trial_count_++] = {to_pose(found.point) * searched_T_scan_};
  }
  trial_scans_ = 0;
  trial_s_ = 0.0;
}

void Relocaliser::try_scan(Slam& slam, const ScanFrame& scan) {
  search_.load(scan, points_);
  static_cast<void>(fit_.load(scan));
  for (Candidate& candidate : candidates_on_trial()) {
    candidate.map_T_scan = to_pose(search_.climb(points_, to_search_point(candidate.map_T_scan), kClimb_steps).point);
    const Fit fit = fit_.in_full(slam.map_view(), slam.map_geometry(), candidate.map_T_scan);
    candidate.fit_sum += fit.mean;
    candidate.known_sum += fit.known_share;
    candidate.in_known_sum += fit.in_known;
  }
  ++trial_scans_;
  drop_doubles();
}

// Best first; of two that have met the better one stays.
void Relocaliser::drop_doubles() {
  const std::span<Candidate> all = candidates_on_trial();
  std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return a.fit_sum > b.fit_sum; });
  std::size_t kept = 0;
  for (const Candidate& candidate : all) {
    const auto same = [&](const Candidate& other) {
      return !clearly_apart(to_search_point(other.map_T_scan), to_search_point(candidate.map_T_scan));
    };
    if (std::none_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kept), same)) {
      all[kept++] = candidate;
    }
  }
  trial_count_ = kept;
}

// A place of which the map lacks a part is one, too, where what it has fits.
bool Relocaliser::has_rival() const {
  const Candidate& best = trial_.front();
  return std::any_of(trial_.begin() + 1, trial_.begin() + static_cast<std::ptrdiff_t>(trial_count_),
                     [&](const Candidate& other) {
                       return other.known_sum > kRival_known * trial_scans_ &&
                              other.in_known_sum > params_.rival_ratio * best.in_known_sum;
                     });
}

std::optional<Pose2> Relocaliser::verdict() {
  if (trial_scans_ < kTrial_scans_min || trial_s_ < params_.found_after_s) {
    return std::nullopt;
  }
  const Candidate best = trial_.front();
  const bool has_rival = this->has_rival();
  const bool fits = best.fit_sum >= fit_min_ * trial_scans_;
  if (fits && has_rival && trial_s_ < params_.give_up_after_s) {
    return std::nullopt;  // what comes may tell them apart
  }
  trial_count_ = 0;  // else all over again, with this scan
  return fits && !has_rival ? std::optional(best.map_T_scan) : std::nullopt;
}

}  // namespace odoless
