#include "firmware/daemon/memory_budget.hpp"

#include <link.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <numeric>

#include "firmware/daemon/machine.hpp"
#include "firmware/pipeline/pipeline.hpp"
#include "firmware/publisher/publisher.hpp"
#include "firmware/sources/lrf_source.hpp"
#include "firmware/sources/tilt_source.hpp"
#include "firmware/stages/filter_stage.hpp"
#include "firmware/stages/matcher_stage.hpp"
#include "firmware/threads/intake.hpp"
#include "firmware/web/web_server.hpp"
#include "rt/real_time_thread.hpp"

namespace odoless {
namespace {

// What the first thread touches of its stack.
constexpr std::size_t kFirstStack_bytes = std::size_t{256} << 10;

std::size_t heap_bytes() {
  const struct mallinfo2 now = mallinfo2();
  return now.uordblks + now.hblkhd;
}

/// Notes by how much the heap has grown since the last note.
class HeapMeter {
 public:
  void note(const char* what) {
    const std::size_t now_bytes = heap_bytes();
    shares_.push_back({what, now_bytes - std::min(now_bytes, before_bytes_)});
    before_bytes_ = heap_bytes();
  }
  [[nodiscard]] std::vector<MemoryShare> take() { return std::move(shares_); }

 private:
  std::vector<MemoryShare> shares_;
  std::size_t before_bytes_ = heap_bytes();
};

int add_segments(dl_phdr_info* info, std::size_t /*size*/, void* sum) {
  const auto page_bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    if (const ElfW(Phdr)& segment = info->dlpi_phdr[i]; segment.p_type == PT_LOAD) {
      *static_cast<std::size_t*>(sum) += (segment.p_memsz + page_bytes - 1) / page_bytes * page_bytes;
    }
  }
  return 0;
}

std::size_t program_bytes() {
  std::size_t sum = 0;
  dl_iterate_phdr(add_segments, &sum);
  return sum;
}

}  // namespace

std::vector<MemoryShare> memory_budget(const DaemonParams& params) {
  HeapMeter meter;
  const auto pipeline = std::make_unique<Pipeline>(params.pipeline, params.robot, false);
  meter.note("queues, scans under way, records to the publisher");
  LineHandover line;
  const LrfParams lrf = params.lrf.driver == LrfDriver::kLcm ? LrfParams{} : params.lrf;
  const LrfSource source(lrf, params.robot.scan.beams_max, line);
  meter.note("laser");
  LineHandover tilt_line;
  const auto tilt =
      params.tilt.driver == TiltDriver::kNone ? nullptr : std::make_unique<TiltSource>(params.tilt, tilt_line);
  meter.note("tilt servo");
  const auto matcher = std::make_unique<MatcherStage>(params.robot, 1);
  meter.note("matcher: local map, rasters, population");
  const auto filter = std::make_unique<FilterStage>(params.robot, 1);
  meter.note("filter: particles and their maps");
  const auto publisher = std::make_unique<Publisher>(PublisherParams{.lcm = params.lcm,
                                                                     .recorder = params.recorder,
                                                                     .health = params.health,
                                                                     .mapping = params.mapping_in_use(),
                                                                     .mount = params.robot.mount,
                                                                     .has_page = params.web.is_used()},
                                                     filter->geometry(), *pipeline, "");
  meter.note("publisher: the map as published and as the page shows it, the 3D map, messages");
  if (params.robot.graph.enabled) {
    publisher->attach(params.robot, 1);
  }
  meter.note("pose graph: keyframes, submaps, constraints");
  std::vector<MemoryShare> shares = meter.take();
  const auto add = [&shares](std::string what, std::size_t bytes) {
    shares.emplace_back().what = std::move(what);
    shares.back().bytes = bytes;
  };
  add("poses that wait for the disk", PoseSpool::kWaitingMax * sizeof(PoseSpool::Entry));
  add("stacks of the threads",
      (kStages + (params.gpio.is_used() ? 1 : 0)) * ThreadParams{}.stack_bytes +
          (params.robot.graph.enabled ? GraphFeed::kStack_bytes + GraphFeed::scratch_bytes(params.robot.graph) : 0) +
          2 * kPublisherStack_bytes + kFirstStack_bytes);
  if (!params.world.file.empty()) {
    add("world file: its thread's stack, pages, what waits", WorldKeeper::kStack_bytes + WorldKeeper::kScratch_bytes);
  }
  if (params.web.is_used()) {
    add("page: stacks of its threads",
        static_cast<std::size_t>(WebServer::threads(params.web)) * WebServer::kStack_bytes);
  }
  add("program and libraries", program_bytes());
  return shares;
}

std::size_t total_bytes(const std::vector<MemoryShare>& shares) {
  return std::accumulate(shares.begin(), shares.end(), std::size_t{0},
                         [](std::size_t sum, const MemoryShare& share) { return sum + share.bytes; });
}

}  // namespace odoless
