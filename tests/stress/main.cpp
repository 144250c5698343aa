// stress NAME [SECONDS]: runs one scenario again and again. Exit status 0 if nothing was found, 1 if a promise was
// broken, 66 from ThreadSanitizer. Without a name: the list of names, with "right" or "wrong".
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/stress/scenarios.hpp"

namespace odoless::stress {
namespace {

struct Run {
  const char* name;
  bool is_right;
  void (*run)(std::uint64_t rounds);
};

constexpr Run kRuns[] = {
    {"rejecting_queue", true, &pass_values}, {"evicting_queue", true, &pass_slots},
    {"latest_value", true, &show_latest},    {"record_ring", true, &pass_records},
    {"seeded_race", false, &race},
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
      std::printf("%s %s\n", run.name, run.is_right ? "right" : "wrong");
    } else if (std::strcmp(run.name, argv[1]) == 0) {
      odoless::stress::repeat_for(run, argc > 2 ? std::atof(argv[2]) : 1.0);
      return EXIT_SUCCESS;
    }
  }
  return argc < 2 ? EXIT_SUCCESS : 64;
}
