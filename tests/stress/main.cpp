// stress NAME [SECONDS]: runs one scenario again and again, on the product's memory orders or on weakened ones. Exit
// status 0 if nothing was found, 1 if a promise was broken, 66 from ThreadSanitizer. Without a name: the list of names,
// with "right" or "weak".
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/stress/orders.hpp"
#include "tests/stress/scenarios.hpp"

namespace odoless::stress {
namespace {

struct Run {
  const char* name;
  bool is_right;
  void (*run)(std::uint64_t rounds);
};

constexpr Run kRuns[] = {
    {"rejecting_queue", true, &pass_values},
    {"evicting_queue", true, &pass_slots<EvictingQueueOrders>},
    {"evicting_queue.unpublished_token", false, &pass_slots<UnpublishedToken>},
    {"evicting_queue.unseen_token", false, &pass_slots<UnseenToken>},
    {"latest_value", true, &show_latest<LatestValueOrders>},
    {"latest_value.unpublished_value", false, &show_latest<UnpublishedValue>},
    {"latest_value.unawaited_reader", false, &show_latest<UnawaitedReader>},
    {"latest_value.unseen_value", false, &show_latest<UnseenValue>},
    {"latest_value.unreleased_buffer", false, &show_latest<UnreleasedBuffer>},
    {"record_ring", true, &pass_records<RecordRingOrders>},
    {"record_ring.unpublished_record", false, &pass_records<UnpublishedRecord>},
    {"record_ring.unseen_record", false, &pass_records<UnseenRecord>},
    {"record_ring.unreleased_room", false, &pass_records<UnreleasedRoom>},
    {"record_ring.unseen_room", false, &pass_records<UnseenRoom>},
};

void repeat_for(const Run& run, double duration_s) {
  using Seconds = std::chrono::duration<double>;
  const auto start = std::chrono::steady_clock::now();
  do {
    run.run(2000);
  } while (Seconds(std::chrono::steady_clock::now() - start).count() < duration_s);
}

}  // namespace
}  // namespace odoless::stress

int main(int argc, char** argv) {
  for (const auto& run : odoless::stress::kRuns) {
    if (argc < 2) {
      std::printf("%s %s\n", run.name, run.is_right ? "right" : "weak");
    } else if (std::strcmp(run.name, argv[1]) == 0) {
      odoless::stress::repeat_for(run, argc > 2 ? std::atof(argv[2]) : 1.0);
      return EXIT_SUCCESS;
    }
  }
  return argc < 2 ? EXIT_SUCCESS : 64;
}
