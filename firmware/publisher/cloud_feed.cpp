#include "firmware/publisher/cloud_feed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace odoless {
namespace {

std::int64_t to_ns(double time_s) { return std::llround(time_s * 1e9); }

std::int64_t last_beam_ns(const ScanRecord& scan) {
  return scan.stamp_ns + scan.beam_period_ns * std::max(scan.beams - 1, 0);
}

}  // namespace

CloudFeed::CloudFeed(const MappingParams& params, int beams_max, const LaserMountParams& mount)
    : params_(params),
      mapper_(params.cloud, TiltMount(params.mount), beams_max),
      mount_(mount, beams_max),
      frame_({.beams_max = beams_max, .range_max_m = params.cloud.range_max_m}),
      tilts_(to_ns(params.angle_gap_max_s)),
      odom_T_scan_(kPoses, to_ns(params.pose_gap_max_s), params.yaw_doubt_max_rad),
      waiting_(kWaiting) {
  for (Waiting& waiting : waiting_) {
    waiting.ranges_m.reserve(static_cast<std::size_t>(beams_max));
  }
  tilts_rad_.reserve(static_cast<std::size_t>(beams_max));
  keys_.reserve(static_cast<std::size_t>(params.cloud.keys_max));
}

void CloudFeed::add(const TiltRecord& tilt) { static_cast<void>(tilts_.add(tilt.stamp_ns, tilt.angle_rad)); }

void CloudFeed::add(const Motion& motion) {
  static_cast<void>(odom_T_scan_.add(motion.to_stamp_ns, motion.odom_T_current));
}

void CloudFeed::add(const PoseRecord& pose) {
  if (has_pose_ && pose.map_number != pose_.map_number) {
    begin_anew();
  } else if (has_pose_ && is_leap(pose)) {
    mapper_.reset();
  }
  pose_ = pose;
  has_pose_ = true;
}

void CloudFeed::begin_anew() {
  for (const KeyState& key : keys_) {
    editions_before_ = std::max(editions_before_, key.edition);
  }
  mapper_.cloud().clear();
  mapper_.reset();
  keys_.clear();
  next_key_ = 0;
}

// Whether the last pose's map_T_odom would put this one somewhere else.
bool CloudFeed::is_leap(const PoseRecord& pose) const {
  const Pose2 expected = pose_.map_T_odom * pose.map_T_odom.inverse() * pose.map_T_scan;
  return expected.distance_m(pose.map_T_scan) > kLeapM;
}

void CloudFeed::add(const ScanRecord& scan, std::span<const float> ranges_m) {
  if (end_ - first_ == kWaiting) {
    drop_oldest();
  }
  Waiting& waiting = waiting_[end_ % kWaiting];
  const std::size_t beams = std::min(ranges_m.size(), waiting.ranges_m.capacity());
  waiting.scan = scan;
  waiting.ranges_m.assign(ranges_m.begin(), ranges_m.begin() + static_cast<std::ptrdiff_t>(beams));
  ++end_;
}

void CloudFeed::drop_oldest() {
  ++first_;
  ++left_out_;
}

CloudFeed::Readiness CloudFeed::readiness(const ScanRecord& scan) const {
  const Errc first = odom_T_scan_.at(scan.stamp_ns).error();
  const Errc last = odom_T_scan_.at(last_beam_ns(scan)).error();
  const Errc angle = tilts_.angle_rad(last_beam_ns(scan)).error();
  if (first == Errc::kNotYet || last == Errc::kNotYet || angle == Errc::kNotYet || !has_pose_) {
    return Readiness::kWait;
  }
  return first == Errc::kOk && last == Errc::kOk ? Readiness::kReady : Readiness::kNever;
}

void CloudFeed::work() {
  for (int i = 0; i < kScansPerRound && first_ != end_; ++i) {
    switch (readiness(oldest().scan)) {
      case Readiness::kWait:
        return;
      case Readiness::kNever:
        drop_oldest();
        break;
      case Readiness::kReady:
        map(oldest());
        ++first_;
        break;
    }
  }
}

void CloudFeed::finish(std::span<const StampedPose> path) {
  for (std::size_t before = first_ + 1; before != first_;) {
    before = first_;
    work();
  }
  correct(path);
}

CloudHealth CloudFeed::health() const {
  const KeyedCloud& cloud = mapper_.cloud();
  return {.points = static_cast<std::int64_t>(cloud.size()),
          .used = cloud.used(),
          .refused = cloud.refused(),
          .scans_left_out = left_out_};
}

void CloudFeed::map(const Waiting& waiting) {
  const RawScan raw{.stamp_ns = waiting.scan.stamp_ns,
                    .start_angle_rad = waiting.scan.start_angle_rad,
                    .angle_step_rad = waiting.scan.angle_step_rad,
                    .beam_period_ns = waiting.scan.beam_period_ns,
                    .ranges_m = waiting.ranges_m};
  const RawScan mounted = mount_.apply(raw);
  if (frame_.assign(mounted) != Errc::kOk) {
    return;
  }
  const std::int64_t first_ns = mounted.stamp_ns + mounted.first_beam_ns;
  const std::int64_t last_ns = first_ns + (frame_.size() - 1) * mounted.beam_period_ns;
  tilts_rad_.clear();
  for (int beam = 0; beam < frame_.size(); ++beam) {
    const Result<double> tilt = tilts_.angle_rad(first_ns + beam * mounted.beam_period_ns);
    tilts_rad_.push_back(tilt.ok() ? tilt.value() : std::numeric_limits<double>::quiet_NaN());
  }
  const ScanMotion odom{odom_T_scan_.at(first_ns).value(), odom_T_scan_.at(last_ns).value()};
  mapper_.add(frame_, tilts_rad_, odom, pose_.map_T_odom);
  remember_keys(raw.stamp_ns);
}

// A key that has just begun hangs on the last pose's update, as that pose does; the one before it is complete.
void CloudFeed::remember_keys(std::int64_t stamp_ns) {
  while (keys_.size() < mapper_.cloud().keys().size()) {
    if (!keys_.empty()) {
      keys_.back().published = 0;
    }
    const Pose2 odom_T_update = pose_.map_T_odom.inverse() * pose_.map_T_scan * pose_.update_T_scan.inverse();
    keys_.push_back(
        {pose_.update_stamp_ns, odom_T_update.inverse() * odom_T_scan_.at(stamp_ns).value(), {}, 0, editions_before_});
  }
}

void CloudFeed::correct(std::span<const StampedPose> path) {
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const auto update =
        std::lower_bound(path.begin(), path.end(), keys_[i].update_stamp_ns,
                         [](const StampedPose& pose, std::int64_t stamp_ns) { return pose.stamp_ns < stamp_ns; });
    if (update == path.end() || update->stamp_ns != keys_[i].update_stamp_ns) {
      continue;
    }
    const Pose2 map_T_key = update->map_T_scan * keys_[i].update_T_key;
    const Pose2& published = keys_[i].map_T_published;
    mapper_.cloud().correct(i, map_T_key);
    if (map_T_key.distance_m(published) > kMovedM ||
        std::abs(wrap_angle(map_T_key.yaw_rad - published.yaw_rad)) > kMovedRad) {
      keys_[i].published = 0;
    }
  }
}

// All points of an edition are published where its first ones were.
void CloudFeed::begin_edition(KeyState& state, const CloudKey& key) {
  if (state.published == 0) {
    state.map_T_published = key.map_T_key;
    ++state.edition;
  }
}

CloudPiece CloudFeed::next_piece(std::size_t points_max) {
  for (std::size_t looked = 0; looked < keys_.size(); ++looked) {
    const std::size_t key = (next_key_ + looked) % keys_.size();
    const std::span<const CloudPoint> points = mapper_.cloud().points_of(key);
    const std::size_t left = points.size() - keys_[key].published;
    if (left >= (key + 1 == keys_.size() ? kNewPointsMin : 1)) {
      const std::span<const CloudPoint> piece = points.subspan(keys_[key].published, std::min(left, points_max));
      const CloudKey& pose = mapper_.cloud().keys()[key];
      begin_edition(keys_[key], pose);
      keys_[key].published += piece.size();
      next_key_ = key;
      return {pose.stamp_ns, static_cast<std::int32_t>(key), keys_[key].edition, keys_[key].map_T_published, piece};
    }
  }
  return {};
}

}  // namespace odoless
