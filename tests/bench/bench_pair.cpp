#include "tests/bench/bench_pair.hpp"

#include <cstdint>
#include <filesystem>
#include <numbers>

#include "core/base/check.hpp"
#include "tests/support/data.hpp"
#include "tests/support/simulated_scene.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kApart_ns = 1'000'000'000;

ScanFrame to_frame(const LogScan& scan) {
  ScanFrame frame(ScanParams{});
  ODOLESS_CHECK(frame.assign(scan.raw()) == Errc::kOk);
  return frame;
}

BenchPair simulated_pair() {
  const SimulatedLaser laser{
      .beams = 360, .start_angle_rad = -0.5 * std::numbers::pi, .angle_step_rad = std::numbers::pi / 360};
  Rng rng(1);
  return {sweep(cluttered_room(), laser, {}, rng), sweep(cluttered_room(), laser, {0.5, 0.1, 0.3}, rng),
          "simulated room: no fr079.clf.xz in ODOLESS_DATA"};
}

BenchPair load() {
  const std::filesystem::path path = test::data_folder() / "fr079.clf.xz";
  if (!std::filesystem::exists(path)) {
    return simulated_pair();
  }
  const ScanLog log = read_scan_log(path);
  std::size_t second = 1;
  while (second + 1 < log.scans.size() && log.scans[second].stamp_ns - log.scans[0].stamp_ns < kApart_ns) {
    ++second;
  }
  return {to_frame(log.scans.at(0)), to_frame(log.scans.at(second)), "fr079, scans 0 and " + std::to_string(second)};
}

}  // namespace

const BenchPair& bench_pair() {
  static const BenchPair pair = load();
  return pair;
}

}  // namespace odoless
