// Sends one of each of our messages, again and again, as a robot would that drives around a room: publisher URL
// SECONDS.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <thread>
#include <vector>

#include "firmware/lcm/lcm_link.hpp"

namespace odoless {
namespace {

constexpr double kRateHz = 20.0;
constexpr double kWallM = 6.0;  // half the side of the room
constexpr int kBeams = 541;
constexpr int kTileCells = 64;
constexpr double kCellM = 0.05;

// Distance to the walls of a square room from inside.
double range_m(const Pose2& map_T_scan, double angle_rad) {
  const double heading_rad = map_T_scan.yaw_rad + angle_rad;
  const double c = std::cos(heading_rad);
  const double s = std::sin(heading_rad);
  const double to_x_m = std::abs(c) < 1e-9 ? 1e9 : ((c > 0.0 ? kWallM : -kWallM) - map_T_scan.x_m) / c;
  const double to_y_m = std::abs(s) < 1e-9 ? 1e9 : ((s > 0.0 ? kWallM : -kWallM) - map_T_scan.y_m) / s;
  return std::min(to_x_m, to_y_m);
}

std::uint8_t occupancy(double x_m, double y_m) {
  const double outermost_m = std::max(std::abs(x_m), std::abs(y_m));
  if (outermost_m > kWallM + 0.1) {
    return kUnknownCell;
  }
  return outermost_m > kWallM - 0.1 ? 95 : 5;
}

class Robot {
 public:
  explicit Robot(LcmLink& link) : link_(link) {}

  bool step() {
    const Pose2 before = map_T_scan_;
    const double turn_rad = 0.05 * static_cast<double>(++steps_);
    map_T_scan_ = {3.0 * std::cos(turn_rad), 3.0 * std::sin(turn_rad), wrap_angle(turn_rad + M_PI / 2.0)};
    const std::int64_t last_stamp_ns = stamp_ns_;
    stamp_ns_ = 1'700'000'000'000'000'000 + steps_ * static_cast<std::int64_t>(1e9 / kRateHz);
    bool ok = send_scan() && send_pose();
    Motion motion = Motion::between(steps_ > 1 ? last_stamp_ns : stamp_ns_, stamp_ns_, before.inverse() * map_T_scan_);
    motion.odom_T_current = map_T_scan_;
    ok = link_.publish(motion) == Errc::kOk && ok;
    return send_tile() && send_overview() && send_health() && ok;
  }

 private:
  bool send_scan() {
    const ScanRecord scan{
        .stamp_ns = stamp_ns_, .start_angle_rad = -2.3561945, .angle_step_rad = 0.0087266, .beams = kBeams};
    std::vector<float> ranges_m(kBeams);
    for (int beam = 0; beam < kBeams; ++beam) {
      const double angle_rad = scan.start_angle_rad + beam * scan.angle_step_rad;
      ranges_m[static_cast<std::size_t>(beam)] =
          beam % 50 == 0 ? std::numeric_limits<float>::infinity() : static_cast<float>(range_m(map_T_scan_, angle_rad));
    }
    const std::vector<std::byte> bytes(100, std::byte{0x30});
    return link_.publish(scan, ranges_m) == Errc::kOk &&
           link_.publish_points({.stamp_ns = stamp_ns_, .map_T_scan = map_T_scan_}, scan, ranges_m) == Errc::kOk &&
           link_.publish(RawBytesRecord{.stamp_ns = stamp_ns_, .size_bytes = 100}, bytes) == Errc::kOk &&
           link_.publish(RawBytesRecord{.stamp_ns = stamp_ns_, .size_bytes = 100, .to_device = 1}, bytes) == Errc::kOk;
  }

  bool send_pose() {
    const TiltRecord tilt{.stamp_ns = stamp_ns_, .angle_rad = 0.1};
    return link_.publish(PoseRecord{.stamp_ns = stamp_ns_, .map_T_scan = map_T_scan_, .particles = 100}) == Errc::kOk &&
           link_.publish(tilt) == Errc::kOk;
  }

  bool send_health() {
    HealthReport health;
    health.stamp_ns = stamp_ns_;
    health.state = HealthState::kOk;
    health.lrf.rate_hz = kRateHz;
    return link_.publish(health) == Errc::kOk;
  }

  bool send_tile() {
    const auto sequence = static_cast<int>(steps_ % 16);
    const MapTileRecord tile{.stamp_ns = stamp_ns_,
                             .column = sequence % 4 - 2,
                             .row = sequence / 4 - 2,
                             .size_cells = kTileCells,
                             .cell_size_m = kCellM};
    std::vector<std::uint8_t> cells(kTileCells * kTileCells);
    for (int i = 0; i < kTileCells * kTileCells; ++i) {
      cells[static_cast<std::size_t>(i)] = occupancy((tile.column * kTileCells + i % kTileCells + 0.5) * kCellM,
                                                     (tile.row * kTileCells + i / kTileCells + 0.5) * kCellM);
    }
    return link_.publish(tile, cells) == Errc::kOk;
  }

  bool send_overview() {
    const std::vector<std::uint8_t> cells(256 * 256, 50);
    return link_.publish(MapView{.stamp_ns = stamp_ns_,
                                 .lower_left_x_m = -6.4,
                                 .lower_left_y_m = -6.4,
                                 .cell_size_m = kCellM,
                                 .columns = 256,
                                 .rows = 256,
                                 .cells = cells}) == Errc::kOk;
  }

  LcmLink& link_;
  std::int64_t steps_ = 0;
  std::int64_t stamp_ns_ = 0;
  Pose2 map_T_scan_{};
};

int publish(const char* url, double duration_s) {
  LcmParams params;
  params.url = url;
  params.raw_bytes = true;
  LcmLink link(params, 256 * 256);
  if (link.open() != Errc::kOk) {
    std::fprintf(stderr, "publisher: %s\n", link.reason().c_str());
    return 69;
  }
  link.send_again();
  Robot robot(link);
  const auto steps = static_cast<int>(duration_s * kRateHz);
  for (int i = 0; i < steps; ++i) {
    if (!robot.step()) {
      std::fprintf(stderr, "publisher: a message was refused\n");
      return 70;
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(1.0 / kRateHz));
  }
  return 0;
}

}  // namespace
}  // namespace odoless

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "publisher URL SECONDS\n");
    return 64;
  }
  return odoless::publish(argv[1], std::atof(argv[2]));
}
