#include "drivers/lrf/rplidar/point_reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "drivers/lrf/rplidar/bytes.hpp"

namespace odoless::rplidar {
namespace {

// Between two neighbouring samples: what a motor can do, with the jitter of an angle.
constexpr double kStepMinDeg = -3.0;
constexpr double kStepMaxDeg = 12.0;
constexpr double kParallaxDegM = 1.5;   ///< over a range: by how much less its angle is compensated than far away
constexpr double kStartMarkDeg = 30.0;  ///< the mark of a turn's start is this near to the front
constexpr int kMisfitsMax = 3;
constexpr double kSweepMaxDeg = 120.0;      ///< of a capsule, and of some lost ones: a larger one could be a turn more
constexpr std::int64_t kUnknownGapMax = 4;  ///< capsules, while it isn't known how far the mirror turns in one

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

constexpr std::size_t kUltraByNext = 2;  ///< points of a capsule that may be told by their difference from the next

}  // namespace

void PointReader::start(const CapsuleFormat* format) {
  format_ = format;
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
  const auto unit_bytes = static_cast<std::int64_t>(packet_bytes());
  return (used_bytes + unit_bytes / 2) / unit_bytes * packet_points() - 1;
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
  const auto capsule = have.first(format_->bytes);
  if (!is_capsule(*format_, capsule)) {
    // Nothing starts where the one before ended: a byte too much in that one, which a sum by XOR need not see.
    is_before_suspect_ = is_before_suspect_ || (!is_marked(have) && !skipping_);
    return skip_one(is_marked(have) ? Outcome::kWrongSum : Outcome::kSkipped);
  }
  const double turned_deg = has_before_ ? sweep_deg(capsule) : 0.0;
  if (has_before_ && !follows_before(capsule, turned_deg)) {
    if (++misfits_ < kMisfitsMax && !is_before_too_old()) {
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
  const std::int64_t samples = sample_after(format_->bytes) - packet_points() + 1 - before_sample_;
  return std::max<std::int64_t>((samples + packet_points() / 2) / packet_points(), 1);
}

/// After so many capsules, the angle no longer tells how far the mirror is.
bool PointReader::is_before_too_old() const {
  const std::int64_t capsules = capsules_since_before();
  return sweep_deg_ > 0.0 ? static_cast<double>(capsules) * sweep_deg_ > kSweepMaxDeg : capsules > kUnknownGapMax;
}

/// How far the mirror has turned since the capsule before, per capsule: some may have been lost.
double PointReader::sweep_deg(std::span<const std::byte> capsule) const {
  const std::int64_t capsules = capsules_since_before();
  const double turned_deg = between_deg(capsule_angle_deg(*format_, before()), capsule_angle_deg(*format_, capsule));
  const double expected_deg = sweep_deg_ * static_cast<double>(capsules);
  const double whole_deg = sweep_deg_ > 0.0 ? turned_deg + 360.0 * std::round((expected_deg - turned_deg) / 360.0)
                                            : (turned_deg < 0.0 ? turned_deg + 360.0 : turned_deg);
  return whole_deg / static_cast<double>(capsules);
}

bool PointReader::follows_before(std::span<const std::byte> capsule, double sweep_deg) const {
  const bool is_usual = sweep_deg_ <= 0.0 || (sweep_deg > 0.75 * sweep_deg_ && sweep_deg < 1.3 * sweep_deg_);
  return !is_first_capsule(*format_, capsule) && !is_before_too_old() && sweep_deg > 0.0 && sweep_deg < kSweepMaxDeg &&
         is_usual;
}

PointReader::Outcome PointReader::on_capsule(std::span<const std::byte> capsule, double sweep_deg) {
  const bool gives_points = std::exchange(has_before_, true) && !std::exchange(is_before_suspect_, false);
  if (gives_points) {
    read_points(*format_, before(), capsule, sweep_deg, points_);
    const bool is_next_lost = format_->type == kUltraType && capsules_since_before() > 1;
    point_count_ = static_cast<std::size_t>(format_->points) - (is_next_lost ? kUltraByNext : 0U);
    first_sample_ = before_sample_;
    sweep_deg_ = sweep_deg;
  }
  std::copy(capsule.begin(), capsule.end(), before_.begin());
  use(format_->bytes);
  skipping_ = false;
  before_sample_ = last_sample() - packet_points() + 1;
  return gives_points ? Outcome::kPoints : Outcome::kMore;
}

PointReader::Outcome PointReader::inspect() {
  const std::size_t trial_bytes = kTrialNodes * kNodeBytes;
  Outcome outcome = Outcome::kMore;
  while (outcome == Outcome::kMore) {
    const std::size_t have = end_ - begin_;
    if (format_ != nullptr) {
      if (have < format_->bytes) {
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
