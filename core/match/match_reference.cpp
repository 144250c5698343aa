#include "core/match/match_reference.hpp"

#include <algorithm>

namespace odoless {
namespace {
constexpr int kPoints_min = 8;

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
  begin_rebuild(scans);
  while (!rebuild_slice()) {
  }
  return empty() ? Errc::kTooFewReturns : Errc::kOk;
}

void MatchReference::begin_rebuild(std::span<const PlacedScan> scans) {
  points_.clear();
  thinned_.clear();
  orientations_.clear();
  wide_ready_ = wide_ndt_ready_ = false;
  wide_ndt_.begin_rebuild();
  wide_.begin_paint();
  scans_ = scans;
  fitting_ = free_ = 0;
  stage_ = Stage::kScans;
}

bool MatchReference::rebuild_slice() {
  if (stage_slice()) {
    go_on();
  }
  return stage_ == Stage::kDone;
}

bool MatchReference::stage_slice() {
  switch (stage_) {
    case Stage::kScans:
      return add_scan();
    case Stage::kExactNdt:
      return exact_ndt_.rebuild_slice(points_, kSlice);
    case Stage::kNdt:
      return ndt_.rebuild_slice(thinned_, kSlice);
    case Stage::kCoarse:
      return coarse_.paint_slice(ndt_, kSlice_px);
    case Stage::kFine:
      return fine_.paint_slice(ndt_, kSlice_px);
    case Stage::kFree:
      return mark_scan_free();
    case Stage::kDone:
      return false;
  }
  ODOLESS_CHECK(false);
}

void MatchReference::go_on() {
  stage_ = static_cast<Stage>(static_cast<int>(stage_) + 1);
  if (stage_ == Stage::kExactNdt) {
    begin_grids();
  } else if (stage_ == Stage::kFree && params_.free_penalty == 0.0) {
    stage_ = Stage::kDone;
  }
}

// The newest come first: what does not fit is the oldest.
bool MatchReference::add_scan() {
  if (fitting_ < scans_.size() && points_.size() + scans_[fitting_].scan->returns() <= points_.capacity()) {
    const auto& [scan, reference_T_scan] = scans_[fitting_++];
    append_thinned(*scan, reference_T_scan, 0.0, points_);
    append_thinned(*scan, reference_T_scan, params_.thinning_m, thinned_);
    orientations_.add(*scan, reference_T_scan.yaw_rad, params_.thinning_m);
    return false;
  }
  return true;
}

void MatchReference::begin_grids() {
  if (points_.size() < kPoints_min) {
    points_.clear();
    stage_ = Stage::kDone;
    return;
  }
  orientations_.smooth();
  exact_ndt_.begin_rebuild();
  ndt_.begin_rebuild();
  coarse_.begin_paint();
  fine_.begin_paint();
}

bool MatchReference::mark_scan_free() {
  if (free_ < fitting_) {
    const auto& [scan, reference_T_scan] = scans_[free_];
    fine_.mark_free(*scan, reference_T_scan, params_.free_margin_m, params_.free_penalty);
    free_ += static_cast<std::size_t>(params_.free_every);
  }
  return free_ >= fitting_;
}

bool MatchReference::prepare_wide(const Deadline& deadline) {
  while (params_.wide_cell_size_m > 0.0 && !wide_ready_) {
    if (deadline.expired()) {
      return false;
    }
    if (!wide_ndt_ready_) {
      wide_ndt_ready_ = wide_ndt_.rebuild_slice(thinned_, kSlice);
    } else {
      wide_ready_ = wide_.paint_slice(wide_ndt_, kSlice_px);
    }
  }
  return true;
}

const ScoreRaster& MatchReference::wide() {
  static_cast<void>(prepare_wide({}));
  return params_.wide_cell_size_m > 0.0 ? wide_ : coarse_;
}

}  // namespace odoless
