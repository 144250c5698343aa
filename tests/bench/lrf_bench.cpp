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

/// A laser at its full rate, as robot files set it.
struct Streamed {
  const char* model;
  LrfParams params;
};

LrfParams params_of(LrfDriver driver, int beams = 720) {
  LrfParams params;
  params.driver = driver;
  params.rplidar_beams = params.ldrobot_beams = params.ydlidar_beams = beams;
  return params;
}

std::vector<Streamed> lasers() {
  LrfParams sick = params_of(LrfDriver::kSick);
  sick.baud = 500000;
  LrfParams every_tenth = params_of(LrfDriver::kSopas);
  every_tenth.skip = 9;
  LrfParams echoes = params_of(LrfDriver::kScip);
  echoes.reading = LrfReading::kStrongestEcho;
  LrfParams time_of_flight = params_of(LrfDriver::kYdlidar, 1800);
  time_of_flight.ydlidar_ranging = LrfRanging::kTimeOfFlight;
  return {{"utm-30lx-ew", echoes},  // 1081 beams at 40 Hz, with all echoes and their intensities
          {"lms291", sick},         // 361 beams at 37.5 Hz
          {"rplidar-a1-1.16", params_of(LrfDriver::kRplidar)},   // nodes
          {"rplidar-a1-1.20", params_of(LrfDriver::kRplidar)},   // express
          {"rplidar-a3", params_of(LrfDriver::kRplidar, 1600)},  // ultra, 15900 points a second
          {"rplidar-s2", params_of(LrfDriver::kRplidar, 1800)},  // dense, 32000 points a second
          {"rplidar-s3", params_of(LrfDriver::kRplidar, 1800)},  // ultra-dense
          {"ld06", params_of(LrfDriver::kLdrobot)},
          {"stl-27l", params_of(LrfDriver::kLdrobot, 2000)},  // 21600 points a second
          {"ydlidar-tg30", time_of_flight},                   // 20000 points a second
          {"lms111", params_of(LrfDriver::kSopas)},           // 541 beams at 50 Hz, text
          {"tim551", params_of(LrfDriver::kSopas)},           // text, 15 Hz
          {"lms4124", every_tenth},                           // 841 beams at 60 Hz
          {"csv", params_of(LrfDriver::kCsv)}};
}

/// CPU time of one piece of a stream, bytes to ranges and stamps. Streamed time over CPU time of 2000 is 0.05 % of a
/// core.
void BM_LaserStream(benchmark::State& state) {
  const auto [model, params] = lasers()[static_cast<std::size_t>(state.range(0))];
  state.SetLabel(model);
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
BENCHMARK(BM_LaserStream)->DenseRange(0, static_cast<int>(lasers().size()) - 1)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace odoless
