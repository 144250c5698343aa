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
constexpr double kStartMarkDeg = 30.0;  ///< the mark of a turn's start is this near to the front
constexpr double kSweepMaxDeg = 120.0;  ///< of one capsule

double between_deg(double from_deg, double to_deg) {
  const double difference_deg = to_deg - from_deg;
  return difference_deg - 360.0 * std::round(difference_deg / 360.0);
}

bool follows(double last_deg, double angle_deg) {
  const double step_deg = between_deg(last_deg, angle_deg);
  return last_deg < 0.0 || (step_deg > kStepMinDeg && step_deg < kStepMaxDeg);
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
  last_angle_deg_ = -1.0;
  has_before_ = false;
  point_count_ = 0;
}

std::int64_t PointReader::last_sample() const {
  return scan_ == RplidarScan::kStandard ? used_bytes_ / static_cast<std::int64_t>(kNodeBytes) - 1
                                         : used_bytes_ / static_cast<std::int64_t>(kCapsuleBytes) * kCapsulePoints - 1;
}

void PointReader::use(std::size_t bytes) {
  begin_ += bytes;
  used_bytes_ += static_cast<std::int64_t>(bytes);
}

PointReader::Outcome PointReader::skip_one(Outcome outcome) {
  use(1);
  return std::exchange(skipping_, true) ? Outcome::kMore : outcome;
}

bool PointReader::is_in_step() const {
  double last_deg = -1.0;
  for (std::size_t i = 0; i < kTrialNodes; ++i) {
    const std::optional<Point> point = node_of(rest().subspan(i * kNodeBytes));
    if (!point || !can_be(*point) || !follows(last_deg, point->angle_deg)) {
      return false;
    }
    last_deg = point->angle_deg;
  }
  return true;
}

PointReader::Outcome PointReader::take_node() {
  const std::optional<Point> point = node_of(rest());
  if (!point || !can_be(*point) || !follows(last_angle_deg_, point->angle_deg)) {
    in_step_ = false;
    last_angle_deg_ = -1.0;
    return std::exchange(skipping_, true) ? Outcome::kMore : Outcome::kSkipped;
  }
  skipping_ = false;
  last_angle_deg_ = point->angle_deg;
  points_[0] = *point;
  point_count_ = 1;
  use(kNodeBytes);
  first_sample_ = last_sample();
  return Outcome::kPoints;
}

PointReader::Outcome PointReader::take_capsule() {
  const auto have = rest();
  if (is_capsule(have)) {
    use(kCapsuleBytes);
    skipping_ = false;
    return on_capsule(have.first(kCapsuleBytes));
  }
  const bool is_marked =
      (std::to_integer<unsigned>(have[0]) >> 4U) == 0xAU && (std::to_integer<unsigned>(have[1]) >> 4U) == 0x5U;
  return skip_one(is_marked ? Outcome::kWrongSum : Outcome::kSkipped);
}

PointReader::Outcome PointReader::on_capsule(std::span<const std::byte> capsule) {
  const double turned_deg = has_before_ ? between_deg(capsule_angle_deg(before_), capsule_angle_deg(capsule)) : 0.0;
  double sweep_deg = turned_deg < 0.0 ? turned_deg + 360.0 : turned_deg;
  const std::int64_t sample = last_sample() - kCapsulePoints + 1;
  const auto capsules = std::max<std::int64_t>((sample - before_sample_ + kCapsulePoints / 2) / kCapsulePoints, 1);
  sweep_deg /= static_cast<double>(capsules);  // some may be lost between the two
  const bool is_news = has_before_ && !is_first_capsule(capsule) && sweep_deg > 0.0 && sweep_deg < kSweepMaxDeg;
  if (is_news) {
    points_ = points_of(before_, sweep_deg);
    point_count_ = points_.size();
    first_sample_ = before_sample_;
  }
  std::copy(capsule.begin(), capsule.end(), before_.begin());
  before_sample_ = sample;
  has_before_ = true;
  return is_news ? Outcome::kPoints : Outcome::kMore;
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
