#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "tests/tools/emulate_support.hpp"

namespace odoless {
namespace {

class Count final : public LrfSink {
 public:
  void on_scan(const LrfScan& scan) override {
    benchmark::DoNotOptimize(scan.ranges_m.data());
    ++scans;
  }
  void on_event(const LrfEvent&) override {}
  std::int64_t scans = 0;
};

/// CPU time of one piece of a stream, bytes to ranges and stamps. Streamed time over CPU time above 100 is under 1 % of
/// a core.
void stream_for_a_while(benchmark::State& state, const std::string& model, const LrfParams& params) {
  std::vector<std::string> pieces;
  test::Bench bench(model, {}, params);
  bench.reset();
  bench.run(4 * test::kSecond);
  bench.on_the_way = [&](std::string& bytes) { pieces.push_back(bytes); };
  bench.run(2 * test::kSecond);
  Count sink;
  std::int64_t now_ns = bench.now_ns();
  const std::int64_t piece_ns = 2 * test::kSecond / static_cast<std::int64_t>(pieces.size());
  std::size_t next = 0;
  std::int64_t streamed_ns = 0;
  for (auto _ : state) {
    const std::string& bytes = pieces[next];
    bench.session().receive(std::as_bytes(std::span(bytes.data(), bytes.size())), now_ns += piece_ns, sink);
    next = (next + 1) % pieces.size();
    streamed_ns += piece_ns;
  }
  const double streamed_s = static_cast<double>(streamed_ns) * 1e-9;
  state.counters["streamed_per_cpu"] = benchmark::Counter(streamed_s, benchmark::Counter::kIsRate);
  state.counters["scans_per_s"] = static_cast<double>(sink.scans) / streamed_s;
}

// 361 beams at 37.5 Hz.
void BM_SickStream(benchmark::State& state) {
  LrfParams params;
  params.driver = LrfDriver::kSick;
  params.baud = 500000;
  stream_for_a_while(state, "lms291", params);
}
BENCHMARK(BM_SickStream)->Unit(benchmark::kMicrosecond);

// 4000 points a second, with sums.
void BM_RplidarExpressStream(benchmark::State& state) {
  LrfParams params;
  params.driver = LrfDriver::kRplidar;
  params.rplidar_scan = RplidarScan::kExpress;
  stream_for_a_while(state, "rplidar-a2", params);
}
BENCHMARK(BM_RplidarExpressStream)->Unit(benchmark::kMicrosecond);

void BM_RplidarStandardStream(benchmark::State& state) {
  LrfParams params;
  params.driver = LrfDriver::kRplidar;
  params.rplidar_scan = RplidarScan::kStandard;
  stream_for_a_while(state, "rplidar-a2", params);
}
BENCHMARK(BM_RplidarStandardStream)->Unit(benchmark::kMicrosecond);

// 15900 points a second by their differences, as 1600 beams.
void BM_RplidarUltraStream(benchmark::State& state) {
  LrfParams params;
  params.driver = LrfDriver::kRplidar;
  params.rplidar_beams = 1600;
  stream_for_a_while(state, "rplidar-a3", params);
}
BENCHMARK(BM_RplidarUltraStream)->Unit(benchmark::kMicrosecond);

// 32000 points a second, as 1800 beams.
void BM_RplidarDenseStream(benchmark::State& state) {
  LrfParams params;
  params.driver = LrfDriver::kRplidar;
  params.rplidar_beams = 1800;
  stream_for_a_while(state, "rplidar-s2", params);
}
BENCHMARK(BM_RplidarDenseStream)->Unit(benchmark::kMicrosecond);

// 4500 points a second.
void BM_LdrobotStream(benchmark::State& state) {
  LrfParams params;
  params.driver = LrfDriver::kLdrobot;
  stream_for_a_while(state, "ld06", params);
}
BENCHMARK(BM_LdrobotStream)->Unit(benchmark::kMicrosecond);

// 21600 points a second, as 2000 beams.
void BM_LdrobotQuickStream(benchmark::State& state) {
  LrfParams params;
  params.driver = LrfDriver::kLdrobot;
  params.ldrobot_beams = 2000;
  stream_for_a_while(state, "stl-27l", params);
}
BENCHMARK(BM_LdrobotQuickStream)->Unit(benchmark::kMicrosecond);

// 20000 points a second, as 1800 beams.
void BM_YdlidarQuickStream(benchmark::State& state) {
  LrfParams params;
  params.driver = LrfDriver::kYdlidar;
  params.ydlidar_beams = 1800;
  params.ydlidar_ranging = LrfRanging::kTimeOfFlight;
  stream_for_a_while(state, "ydlidar-tg30", params);
}
BENCHMARK(BM_YdlidarQuickStream)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace odoless
