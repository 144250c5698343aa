#include <dirent.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <set>

#include "firmware/daemon/daemon.hpp"
#include "firmware/daemon/machine.hpp"
#include "firmware/daemon/memory_budget.hpp"
#include "firmware/threads/filter_loop.hpp"
#include "firmware/threads/matcher_loop.hpp"
#include "tests/keys/key_class.hpp"
#include "tests/support/simulated_room.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/times.hpp"

namespace odoless::test {
namespace {

using test::kSecond;

/// Little memory, and an update of the filter with every scan.
constexpr const char* kLittle = R"(
[scan]
beams_max = 128
[gate]
distance_m = 0.0
[matcher]
points_max = 512
[odometry]
key_scans = 4
[slam.low]
particles = 60
[slam.low.grid]
width_m = 24.0
height_m = 24.0
tiles_max = 800
[control]
socket = ""
[lcm]
url = ""
)";

/// The threads that the daemon has made, with how each is scheduled and where.
std::string threads() {
  std::set<std::string> lines;  // by name
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    const int id = std::stoi(entry.path().filename());
    std::string name = content_of(entry.path() / "comm");
    name.pop_back();
    sched_param scheduling{};
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    if (name.starts_with("odo-") && sched_getparam(id, &scheduling) == 0 &&
        sched_getaffinity(id, sizeof(cpus), &cpus) == 0) {
      lines.insert(fmt::format("{}: policy {}, priority {}, {} processors\n", name, sched_getscheduler(id),
                               scheduling.sched_priority, CPU_COUNT(&cpus)));
    }
  }
  return fmt::format("{}", fmt::join(lines, ""));
}

/// A laser that says nothing for so long, and then no more.
class QuietSource final : public ScanSource {
 public:
  explicit QuietSource(
      std::int64_t hangs_ns = 0, std::function<void()> meanwhile = [] {})
      : hangs_ns_(hangs_ns), meanwhile_(std::move(meanwhile)) {}
  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] std::int64_t next_deadline_ns() const override { return 0; }
  void work(const Clock& /*clock*/, ScanSink& /*sink*/) override {
    if (!is_exhausted_) {
      meanwhile_();
      sleep_ns(hangs_ns_);
      is_exhausted_ = true;
    }
  }
  [[nodiscard]] bool is_open() const override { return true; }
  [[nodiscard]] bool is_exhausted() const override { return is_exhausted_; }
  void add_counts(SourceHealth& /*health*/) const override {}

 private:
  std::int64_t hangs_ns_;
  std::function<void()> meanwhile_;
  std::atomic<bool> is_exhausted_ = false;
};

/// How the threads run, or why they do not as configured.
std::string scheduled(const DaemonParams& params) {
  DaemonOptions options;
  options.params = params;
  options.source = std::make_unique<QuietSource>(50'000'000);
  Machine machine(options);
  EXPECT_EQ(machine.start(false), 0);
  const std::string text = threads() + fmt::format("refused: {}\n", machine.scheduling_error());
  EXPECT_TRUE(machine.stop());
  return text;
}

/// What `odoless memory` says, in megabytes: to some 50 kB it depends on what the heap was used for before.
std::string reserved(const DaemonParams& params) {
  std::string text;
  for (const MemoryShare& share : memory_budget(params)) {
    text += fmt::format("{}: {} MB\n", share.what, (share.bytes + 500'000) / 1'000'000);
  }
  return text;
}

/// Whether matches are cut short.
std::string matched(const DaemonParams& params) {
  Pipeline pipeline(params.pipeline, params.robot, false);
  MatcherStage stage(params.robot, 1);
  MatcherLoop loop(pipeline, stage, params.pipeline.matcher_budget_ns, false);
  SimulatedRoom room(4, 100);
  pipeline.sensor.done.store(true);  // nothing comes but what is there
  bool is_cut = false;
  for (int i = 0; i < 4; ++i) {
    room.step();
    pipeline.pool.at(0) = room.scan();
    EXPECT_FALSE(pipeline.scans.push(0));
    loop.run();
    ScanSlot slot = kNoSlot;
    EXPECT_TRUE(pipeline.slots_from_matcher.try_pop(slot));
    EXPECT_TRUE(pipeline.matcher.report.update());
    is_cut = is_cut || pipeline.matcher.report.value().deadline_hit;
  }
  return is_cut ? "cut" : "whole";
}

/// What the filter does in its time, if matches took 8 s each, and how many tiles of the map it sends.
std::string filtered(const DaemonParams& params) {
  constexpr std::int64_t kMatch_ns = 8 * kSecond;
  Pipeline pipeline(params.pipeline, params.robot, false);
  FilterStage stage(params.robot, 1);
  FilterLoop loop(pipeline, stage, params.pipeline, params.lcm.map_refresh_s);
  const std::atomic<bool> before{true};
  SimulatedRoom room(4);
  int tiles = 0;
  for (int i = 0; i < 20; ++i) {
    room.step();
    pipeline.pool.at(0) = room.scan();
    MotionMessage message{.slot = 0, .motion = room.motion(), .matcher_cpu_ns = kMatch_ns};
    message.motion.odom_T_current = room.map_T_scan();
    EXPECT_TRUE(pipeline.motions.try_push(message));
    loop.run(before);
    ScanSlot slot = kNoSlot;
    EXPECT_TRUE(pipeline.slots_from_filter.try_pop(slot));
    while (const auto record = pipeline.filter.outbox.ring().front()) {
      tiles += record->type == static_cast<std::uint32_t>(RecordType::kMapTile) ? 1 : 0;
      pipeline.filter.outbox.ring().pop();
    }
  }
  EXPECT_TRUE(pipeline.filter.report.update());
  const FilterReport& report = pipeline.filter.report.value();
  return fmt::format("{} updates cut, {} particles, {} tiles\n", report.updates_cut, report.particles, tiles);
}

/// A whole daemon whose sensor thread hangs for 1.5 s: how it ends, what it makes and saves.
std::string ran(const std::filesystem::path& folder, const DaemonParams& params) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const pid_t child = ::fork();
  if (child == 0) {
    std::ofstream log(folder.string() + ".log");
    const auto list = [&] {
      std::set<std::string> names;
      for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        names.insert(entry.path().filename());
      }
      log << fmt::format("{}\n", fmt::join(names, " ")) << std::flush;
    };
    DaemonOptions options;
    options.params = params;
    options.folder = folder;
    options.source = std::make_unique<QuietSource>(1'500'000'000, list);
    options.save = [&log](const SaveRequest& /*request*/, const auto& result_of, const SaveProgress& /*progress*/) {
      const DaemonResult result = result_of();
      log << fmt::format("cloud: {} as {}\n", result.health.cloud.has_value(), static_cast<int>(result.cloud_format))
          << std::flush;
      return SaveOutcome{};
    };
    std::freopen("/dev/null", "w", stderr);
    const int status = run_daemon(std::move(options));
    log << std::flush;
    ::_exit(status);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return fmt::format("status {}\n", WIFEXITED(status) ? WEXITSTATUS(status) : -1) +
         content_of(folder.string() + ".log");
}

Scene daemon_in(const std::shared_ptr<TemporaryFolder>& folder) {
  const std::filesystem::path run = folder->path() / "run";
  return {"daemon",
          {kLittle, fmt::format("control.socket = \"{}\"\n", (run / "control").string()),
           "[pipeline]\nwatchdog_ms = 300\n[tilt]\ndriver = \"dynamixel\"\n"
           "[mapping]\ncloud.points_max = 10000\ncloud.keys_max = 10\n"
           "cloud.key_voxels_max = 4000\n"},
          [folder, run](const DaemonParams& params) { return ran(run, params); }};
}

std::vector<Scene> pipeline_scenes() {
  const std::string patient =
      "[pipeline]\nmatcher_budget_ms = 10000\nfilter_budget_ms = 10000\nscan_budget_ms = 20000\nparticles_min = 10\n";
  return {{"threads", {kLittle}, scheduled},
          {"matcher",
           {kLittle, patient, "matcher.search = { coarse_evaluations = 20000, fine_evaluations = 20000 }"},
           matched},
          {"filter", {kLittle, patient}, filtered}};
}

}  // namespace

std::vector<KeyClass> thread_classes() {
  const auto daemon_scenes = [] { return std::vector<Scene>{daemon_in(std::make_shared<TemporaryFolder>())}; };
  const auto memory_scenes = [] {
    return std::vector<Scene>{{"memory",
                               {kLittle, "scan.beams_max = 2048\nslam.high.particles = 10",
                                "graph = { keyframes_max = 2400, references = 1 }"},
                               reserved}};
  };
  return {{"pipeline", {"pipeline.", "lcm.map_refresh"}, pipeline_scenes, lack_of_real_time},
          {"daemon", {"pipeline.watchdog", "control.", "mapping.enabled", "mapping.save_as"}, daemon_scenes},
          {"memory",
           {"pipeline.scan_queue", "pipeline.motion_queue", "slam.low.path_records_max", "slam.high.path_records_max",
            "graph.submaps_max", "graph.constraints_max", "graph.keyframes_max", "graph.references"},
           memory_scenes}};
}

}  // namespace odoless::test
