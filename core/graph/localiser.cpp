#include "core/graph/localiser.hpp"

#include <algorithm>
#include <cmath>

#include "core/graph/world_parts.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kPiece_m = 0.8;
constexpr double kPath_m = 3.0;          // that is matched as a whole
constexpr double kTurn_m_per_rad = 0.2;  // what a turn adds to a path's length
constexpr std::size_t kPieceScans_max = 24;
constexpr std::size_t kPathScans_max = 3 * kPieceScans_max;
constexpr std::int64_t kPieces = 24;  // that are remembered
constexpr std::size_t kPlaces_max = 24;
constexpr double kPlace_share = 0.75;  // of the best place's score
constexpr double kBox_m = 0.8;
constexpr double kBox_rad = 0.15;
constexpr double kAgreement_min = 0.75;
constexpr double kCoverage_min = 0.4;
// Of several hundred matches in recorded worlds: as many right ones as wrong ones are as good as this, and twice the
// logarithm of the odds for each thirtieth more.
constexpr double kEven_piece = 0.70;
constexpr double kEven_path = 0.70;
constexpr double kExplained_share = 0.5;  // what a beam's fit counts beside the score
constexpr double kWorth_per_quality = 35.0;
constexpr double kWorth_max = 4.5;
constexpr double kWorth_expected = 5.0;
constexpr double kWorth_guess = 2.0;  // in a world of so many submaps; the more places, the more wrong ones fit
constexpr double kWorth_found = 5.0;
constexpr double kFew_submaps = 40.0;
constexpr double kWorth_margin = 2.5;  // over any other place
constexpr double kAgree_share = 0.6;   // of the pieces, from the first one that agrees on
constexpr double kPieces_found = 8.0;  // corridors of different buildings are alike for some metres
constexpr double kAgree_m = 0.6;
constexpr double kAgree_rad = 0.08;
constexpr double kApart_m = 1.2;  // from which on it is another place
constexpr double kApart_rad = 0.2;
constexpr double kVerify_m = 0.4;  // box of the match of the whole path
constexpr double kVerify_rad = 0.06;
constexpr double kExpected_m = 3.0;  // a robot that drove on for a second or two, and turned anyhow

}  // namespace

Localiser::Localiser(const GraphParams& params, const ScanParams& scan)
    : search_(scan, params.keyframe_beams_max), fit_(scan, params.keyframe_beams_max) {}

void Localiser::expect(int component, const Pose2& map_T_scan, const Pose2& odom_T_scan) {
  expected_component_ = component;
  expected_map_T_odom_ = map_T_scan * odom_T_scan.inverse();
  is_hurried_ = true;
}

void Localiser::forget() {
  path_.clear();
  piece_begin_ = 0;
  pieces_ = 0;
  candidates_.clear();
  found_.reset();
  guess_.reset();
  expected_map_T_odom_.reset();
  is_hurried_ = true;
  stage_ = Stage::kIdle;
}

void Localiser::renumber(int first, int keyframes) {
  while (!path_.empty() && path_.front().odom.keyframe < first + keyframes) {
    path_.erase(path_.begin());
    piece_begin_ -= piece_begin_ > 0 ? 1 : 0;
  }
  for (PathPoint& each : path_) {
    each.odom.keyframe -= keyframes;
  }
}

void Localiser::add(const KeyframeStore& store, int keyframe) {
  const OdometryStretch& step = store[keyframe].since_last;
  if (step.is_torn() && !path_.empty()) {
    forget();
  }
  const double way_m = path_.empty() ? 0.0 : path_.back().way_m + step.distance_m + kTurn_m_per_rad * step.rotation_rad;
  path_.push_back({{keyframe, store[keyframe].odom_T_scan}, way_m});
  while (path_.size() > kPathScans_max || path_.front().way_m < way_m - kPath_m) {
    path_.erase(path_.begin());
    piece_begin_ -= piece_begin_ > 0 ? 1 : 0;
  }
  begin_next_piece(store);
}

void Localiser::take_piece(std::size_t begin, std::size_t end) {
  odom_T_piece_ = path_[(begin + end) / 2].odom.piece_T_scan;
  piece_.clear();
  for (std::size_t i = begin; i < end; ++i) {
    piece_.push_back({path_[i].odom.keyframe, odom_T_piece_.inverse() * path_[i].odom.piece_T_scan});
  }
}

void Localiser::begin_next_piece(const KeyframeStore& store) {
  if (has_work()) {
    return;
  }
  bool is_whole = false;
  std::size_t end = piece_begin_;
  while (end < path_.size() && !is_whole) {
    ++end;
    is_whole = path_[end - 1].way_m - path_[piece_begin_].way_m >= kPiece_m || end - piece_begin_ == kPieceScans_max;
  }
  if (!is_whole && !(is_hurried_ && end > piece_begin_)) {
    return;
  }
  take_piece(piece_begin_, end);
  piece_begin_ = end;
  search_.begin(store, piece_);
  ++pieces_;
  std::erase_if(candidates_, [this](const Candidate& each) { return each.piece + kPieces <= pieces_; });
  next_ = 0;
  is_hurried_ = false;
  stage_ = Stage::kLook;
}

bool Localiser::work(const SubmapWorld& world, int submaps, SubmapMatcher& matcher, Rng& rng) {
  if (stage_ == Stage::kLook) {
    if (next_ == 0) {
      tells_ = tell_places(world, submaps);
    }
    while (next_ < submaps && !tells_[static_cast<std::size_t>(next_)]) {
      ++next_;
    }
    if (next_ < submaps) {
      search_.look(world, next_++);
    }
    if (next_ == submaps) {
      take_places();
      matcher.set_query(world.store, piece_);
      stage_ = Stage::kMatch;
    }
  } else if (stage_ == Stage::kMatch) {
    if (!places_.empty()) {
      try_place(world, matcher, rng);
    } else {
      agreement_ = judge(submaps);
      stage_ = agreement_.members.empty() ? Stage::kIdle : Stage::kVerify;
      guess_ = agreement_.members.empty() ? std::nullopt : guess_;
    }
  } else if (stage_ == Stage::kVerify) {
    verify(world, matcher, rng);
    stage_ = Stage::kIdle;
  }
  begin_next_piece(world.store);
  return has_work();
}

void Localiser::take_places() {
  places_.clear();
  for (const FoundPlace& place : search_.found()) {
    if (places_.size() < kPlaces_max && place.score > kPlace_share * search_.found().front().score) {
      places_.push_back(place);
    }
  }
  // Those of one submap after each other: making it ready takes longer than a match.
  std::stable_sort(places_.begin(), places_.end(),
                   [](const FoundPlace& a, const FoundPlace& b) { return a.submap > b.submap; });
}

std::optional<double> Localiser::quality(const SubmapWorld& world, int reference, const SubmapMatch& match) {
  if (!match.is_inside || match.is_weak || match.agreement < kAgreement_min || match.coverage < kCoverage_min) {
    return std::nullopt;
  }
  return match.score + kExplained_share * fit_.explained(world, reference, piece_, match.reference_T_query);
}

void Localiser::try_place(const SubmapWorld& world, SubmapMatcher& matcher, Rng& rng) {
  const FoundPlace place = places_.back();
  places_.pop_back();
  const SubmapMatch match = matcher.match(world, place.submap, {place.submap_T_piece, kBox_m, kBox_rad}, rng);
  const double worth =
      std::min(kWorth_max, kWorth_per_quality * (quality(world, place.submap, match).value_or(0.0) - kEven_piece));
  if (worth > 0.0) {
    candidates_.push_back(
        {pieces_,
         world.graph.component(place.submap),
         world.graph.pose(place.submap) * match.reference_T_query * odom_T_piece_.inverse(),
         worth,
         {place.submap, piece_[piece_.size() / 2].keyframe, false, match.covariance, match.reference_T_query}});
  }
}

void Localiser::verify(const SubmapWorld& world, SubmapMatcher& matcher, Rng& rng) {
  const Candidate& newest = candidates_[agreement_.members.back()];
  take_piece(0, path_.size());
  matcher.set_query(world.store, piece_);
  const int reference = newest.match.reference;
  const Pose2 expected = world.graph.pose(reference).inverse() * newest.map_T_odom * odom_T_piece_;
  const SubmapMatch match = matcher.match(world, reference, {expected, kVerify_m, kVerify_rad}, rng);
  guess_.reset();
  if (quality(world, reference, match).value_or(0.0) > kEven_path) {
    guess_ = world.graph.pose(reference) * match.reference_T_query * odom_T_piece_.inverse();
    if (agreement_.is_sure) {
      found_ = {reference, piece_[piece_.size() / 2].keyframe, is_expected(newest), match.covariance,
                match.reference_T_query};
    }
  }
}

bool Localiser::agree(const Candidate& a, const Candidate& b) const {
  return a.component == b.component &&
         are_within(a.map_T_odom * odom_T_piece_, b.map_T_odom * odom_T_piece_, kAgree_m, kAgree_rad);
}

bool Localiser::are_apart(const Candidate& a, const Candidate& b) const {
  return a.component != b.component ||
         !are_within(a.map_T_odom * odom_T_piece_, b.map_T_odom * odom_T_piece_, kApart_m, kApart_rad);
}

Localiser::Agreement Localiser::agreeing_with(const Candidate& with) const {
  Agreement out;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& each = candidates_[i];
    if (!agree(each, with)) {
      continue;
    }
    if (out.members.empty() || candidates_[out.members.back()].piece != each.piece) {
      out.members.push_back(i);
      out.worth += each.worth;
    } else if (Candidate const& other = candidates_[out.members.back()]; other.worth < each.worth) {
      out.worth += each.worth - other.worth;
      out.members.back() = i;
    }
  }
  return out;
}

bool Localiser::is_expected(const Candidate& candidate) const {
  return expected_map_T_odom_ && candidate.component == expected_component_ &&
         (candidate.map_T_odom * odom_T_piece_).distance_m(*expected_map_T_odom_ * odom_T_piece_) < kExpected_m;
}

// What is expected needs less, but nothing may fit much better: the robot may have been carried off.
Localiser::Agreement Localiser::judge(int submaps) const {
  Agreement best;
  const Candidate* winner = nullptr;
  for (const Candidate& each : candidates_) {
    if (Agreement agreement = agreeing_with(each); agreement.worth > best.worth) {
      best = std::move(agreement);
      winner = &each;
    }
  }
  if (winner == nullptr) {
    return {};
  }
  const bool was_expected = is_expected(*winner);
  const double ahead = was_expected ? kWorth_expected : 0.0;
  const bool has_rival = std::any_of(candidates_.begin(), candidates_.end(), [&](const Candidate& each) {
    return are_apart(each, *winner) &&
           agreeing_with(each).worth > best.worth - kWorth_margin + (is_expected(each) ? 0.0 : ahead);
  });
  const auto votes = static_cast<double>(best.members.size());
  const auto pieces = static_cast<double>(pieces_ - candidates_[best.members.front()].piece + 1);
  const double worth =
      best.worth +
      (was_expected ? kWorth_expected : -math::log(std::max(1.0, static_cast<double>(submaps) / kFew_submaps)));
  best.is_sure = worth >= kWorth_found && (votes >= kPieces_found || was_expected);
  return !has_rival && worth >= kWorth_guess && votes >= kAgree_share * pieces ? best : Agreement{};
}

}  // namespace odoless
