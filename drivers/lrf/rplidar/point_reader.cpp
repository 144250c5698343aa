#include "drivers/lrf/rplidar/point_reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace odoless::rplidar {
namespace {

// Between two neighbouring samples: what a motor can do, with the jitter of an angle.
constexpr double kStepMinDeg = -3.0;
constexpr double kStepMaxDeg = 12.0;
constexpr double kParallaxDegM = 1.5;   ///< over a range: by how much less its angle is compensated than far away
constexpr double kStartMarkDeg = 30.0;  ///< the mark of a turn's start is this near to the front
constexpr int kMisfitsMax = 3;
constexpr std::int64_t kGapMax = 4;     ///< capsules; after more, the angle no longer tells how far the mirror is
constexpr double kSweepMaxDeg = 120.0;  ///< of one capsule

double between_deg(double from_deg, double to_deg) {
  const double difference_deg = to_deg - from_deg;
  return difference_deg - 360.0 * std::round(difference_deg / 360.0);
}

/// By how much the compensations of two points may differ. Where one has no range, it may have none.
double compensation_change_deg(const Point& a, const Point& b) {
  return kParallaxDegM / std::max(std::min(a.range_m, b.range_m), kParallaxDegM / kCompensationMaxDeg);
}

bool follows(const std::optional<Point>& last, const Point& point) {
  if (!last) {
    return true;
  }
  const double step_deg = between_deg(last->angle_deg, point.angle_deg);
  const double change_deg = compensation_change_deg(*last, point);
  return step_deg > kStepMinDeg - change_deg && step_deg < kStepMaxDeg + change_deg;
}

bool can_be(const Point& point) {
  return !point.starts_turn || std::abs(between_deg(0.0, point.angle_deg)) < kStartMarkDeg;
}

}  // namespace

void PointReader::clear() {
  begin_ = 0;
  end_ = 0;
  used_bytes_ = 0;
  in_step_ = false;
  skipping_ = false;
  last_.reset();
  has_before_ = false;
  sweep_deg_ = 0.0;
  is_before_suspect_ = false;
  misfits_ = 0;
  point_count_ = 0;
}

std::int64_t PointReader::sample_after(std::size_t bytes) const {
  const std::int64_t used_bytes = used_bytes_ + static_cast<std::int64_t>(bytes);
  const std::int64_t unit_bytes = scan_ == RplidarScan::kStandard ? kNodeBytes : kCapsuleBytes;
  const std::int64_t unit_samples = scan_ == RplidarScan::kStandard ? 1 : kCapsulePoints;
  return (used_bytes + unit_bytes / 2) / unit_bytes * unit_samples - 1;
}

std::int64_t PointReader::last_sample() const { return sample_after(0); }

void PointReader::use(std::size_t bytes) {
  begin_ += bytes;
  used_bytes_ += static_cast<std::int64_t>(bytes);
}

PointReader::Outcome PointReader::skip_one(Outcome outcome) {
  use(1);
  return std::exchange(skipping_, true) ? Outcome::kMore : outcome;
}

bool PointReader::is_in_step() const {
  std::optional<Point> last;
  for (std::size_t i = 0; i < kTrialNodes; ++i) {
    const std::optional<Point> point = node_of(rest().subspan(i * kNodeBytes));
    if (!point || !can_be(*point) || !follows(last, *point)) {
      return false;
    }
    last = point;
  }
  return true;
}

PointReader::Outcome PointReader::take_node() {
  const std::optional<Point> point = node_of(rest());
  if (!point || !can_be(*point) || !follows(last_, *point)) {
    in_step_ = false;
    last_.reset();
    return std::exchange(skipping_, true) ? Outcome::kMore : Outcome::kSkipped;
  }
  skipping_ = false;
  last_ = point;
  points_[0] = *point;
  point_count_ = 1;
  use(kNodeBytes);
  first_sample_ = last_sample();
  return Outcome::kPoints;
}

PointReader::Outcome PointReader::take_capsule() {
  const auto have = rest();
  const auto capsule = have.first(kCapsuleBytes);
  if (!is_capsule(capsule)) {
    const bool is_marked =
        (std::to_integer<unsigned>(have[0]) >> 4U) == 0xAU && (std::to_integer<unsigned>(have[1]) >> 4U) == 0x5U;
    // Nothing starts where the one before ended: a byte too much in that one, which a sum by XOR need not see.
    is_before_suspect_ = is_before_suspect_ || (!is_marked && !skipping_);
    return skip_one(is_marked ? Outcome::kWrongSum : Outcome::kSkipped);
  }
  const double turned_deg = has_before_ ? sweep_deg(capsule) : 0.0;
  if (has_before_ && !follows_before(capsule, turned_deg)) {
    if (++misfits_ < kMisfitsMax && capsules_since_before() <= kGapMax) {
      return skip_one(Outcome::kSkipped);
    }
    has_before_ = false;  // the mirror has another pace, or the stream is a new one
    sweep_deg_ = 0.0;
    misfits_ = 0;
    return Outcome::kBroken;
  }
  misfits_ = 0;
  return on_capsule(capsule, turned_deg);
}

/// One, and how many were lost, up to the capsule that has been received but isn't used yet.
std::int64_t PointReader::capsules_since_before() const {
  const std::int64_t samples = sample_after(kCapsuleBytes) - kCapsulePoints + 1 - before_sample_;
  return std::max<std::int64_t>((samples + kCapsulePoints / 2) / kCapsulePoints, 1);
}

/// How far the mirror has turned since the capsule before, per capsule: some may have been lost.
double PointReader::sweep_deg(std::span<const std::byte> capsule) const {
  const std::int64_t capsules = capsules_since_before();
  const double turned_deg = between_deg(capsule_angle_deg(before_), capsule_angle_deg(capsule));
  const double expected_deg = sweep_deg_ * static_cast<double>(capsules);
  const double whole_deg = sweep_deg_ > 0.0 ? turned_deg + 360.0 * std::round((expected_deg - turned_deg) / 360.0)
                                            : (turned_deg < 0.0 ? turned_deg + 360.0 : turned_deg);
  return whole_deg / static_cast<double>(capsules);
}

bool PointReader::follows_before(std::span<const std::byte> capsule, double sweep_deg) const {
  const bool is_usual = sweep_deg_ <= 0.0 || (sweep_deg > 0.75 * sweep_deg_ && sweep_deg < 1.3 * sweep_deg_);
  return !is_first_capsule(capsule) && capsules_since_before() <= kGapMax && sweep_deg > 0.0 &&
         sweep_deg < kSweepMaxDeg && is_usual;
}

PointReader::Outcome PointReader::on_capsule(std::span<const std::byte> capsule, double sweep_deg) {
  const bool gives_points = std::exchange(has_before_, true) && !std::exchange(is_before_suspect_, false);
  if (gives_points) {
    points_ = points_of(before_, sweep_deg);
    point_count_ = points_.size();
    first_sample_ = before_sample_;
    sweep_deg_ = sweep_deg;
  }
  std::copy(capsule.begin(), capsule.end(), before_.begin());
  use(kCapsuleBytes);
  skipping_ = false;
  before_sample_ = last_sample() - kCapsulePoints + 1;
  return gives_points ? Outcome::kPoints : Outcome::kMore;
}

PointReader::Outcome PointReader::inspect() {
  const std::size_t trial_bytes = kTrialNodes * kNodeBytes;
  Outcome outcome = Outcome::kMore;
  while (outcome == Outcome::kMore) {
    const std::size_t have = end_ - begin_;
    if (scan_ == RplidarScan::kExpress) {
      if (have < kCapsuleBytes) {
        break;
      }
      outcome = take_capsule();
    } else if (in_step_) {
      if (have < kNodeBytes) {
        break;
      }
      outcome = take_node();
    } else {
      if (have < trial_bytes) {
        break;
      }
      in_step_ = is_in_step();
      outcome = in_step_ ? Outcome::kMore : skip_one(Outcome::kSkipped);
    }
  }
  return outcome;
}

PointReader::Outcome PointReader::take(std::span<const std::byte>& bytes) {
  for (;;) {
    if (const Outcome outcome = inspect(); outcome != Outcome::kMore) {
      return outcome;
    }
    if (bytes.empty()) {
      return Outcome::kMore;
    }
    if (begin_ > 0) {
      std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_),
                bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
      end_ -= begin_;
      begin_ = 0;
    }
    const std::size_t count = std::min(bytes.size(), bytes_.size() - end_);
    std::copy_n(bytes.begin(), count, bytes_.begin() + static_cast<std::ptrdiff_t>(end_));
    end_ += count;
    bytes = bytes.subspan(count);
  }
}

}  // namespace odoless::rplidar
