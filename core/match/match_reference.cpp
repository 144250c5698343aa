#include "core/match/match_reference.hpp"

#include <algorithm>

namespace odoless {
namespace {
constexpr int kReturns_min = 8;

NdtParams with_wide_cells(const ReferenceParams& params) {
  NdtParams out = params.ndt;
  if (params.wide_cell_size_m > 0.0) {
    out.cell_size_m = params.wide_cell_size_m;
  }
  return out;
}
}  // namespace

MatchReference::MatchReference(const ReferenceParams& params, int points_max)
    : params_(params),
      points_(points_max),
      thinned_(points_max),
      exact_ndt_(params.ndt, points_max),
      ndt_(params.ndt, points_max),
      wide_ndt_(with_wide_cells(params), params.wide_cell_size_m > 0.0 ? points_max : 1),
      fine_(params.fine),
      coarse_(params.coarse),
      wide_(params.coarse) {
  ODOLESS_CHECK(parameters_in_range(params));
}

Errc MatchReference::rebuild(std::span<const PlacedScan> scans) {
  points_.clear();
  thinned_.clear();
  orientations_.clear();
  wide_ready_ = false;
  std::size_t fitting = 0;
  for (const PlacedScan& placed : scans) {
    if (points_.size() + placed.scan->returns() > points_.capacity()) {
      break;  // the newest come first: what does not fit is the oldest
    }
    append_thinned(*placed.scan, placed.reference_T_scan, 0.0, points_);
    append_thinned(*placed.scan, placed.reference_T_scan, params_.thinning_m, thinned_);
    orientations_.add(*placed.scan, placed.reference_T_scan.yaw_rad, params_.thinning_m);
    ++fitting;
  }
  if (points_.size() < kReturns_min) {
    points_.clear();
    return Errc::kTooFewReturns;
  }
  orientations_.smooth();
  exact_ndt_.rebuild(points_);
  ndt_.rebuild(thinned_);
  coarse_.paint(ndt_);
  fine_.paint(ndt_);
  if (params_.free_penalty > 0.0) {
    for (std::size_t i = 0; i < fitting; i += static_cast<std::size_t>(params_.free_every)) {
      fine_.mark_free(*scans[i].scan, scans[i].reference_T_scan, params_.free_margin_m, params_.free_penalty);
    }
  }
  return Errc::kOk;
}

const ScoreRaster& MatchReference::wide() {
  if (params_.wide_cell_size_m == 0.0) {
    return coarse_;
  }
  if (!wide_ready_) {
    wide_ndt_.rebuild(thinned_);
    wide_.paint(wide_ndt_);
    wide_ready_ = true;
  }
  return wide_;
}

}  // namespace odoless
