#include <fcntl.h>
#include <fmt/format.h>
#include <gpiod.h>
#include <sched.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <map>
#include <mutex>

#include "firmware/gpio/gpio_thread.hpp"
#include "firmware/threads/round.hpp"
#include "tests/keys/key_class.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/times.hpp"

// A chip without hardware, instead of libgpiod's: where there is a kernel with gpio-sim, tests/hil/gpio_test.py has the
// library and the kernel do the same.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
struct gpiod_chip {};

struct gpiod_line {
  std::string name;
  std::vector<std::pair<std::int64_t, int>> levels{};  ///< that it was set to, each time another one, and when
  std::array<int, 2> edges{-1, -1};
};

namespace {

std::map<std::string, gpiod_line> lines_of_the_board{
    {"stop", {"stop"}}, {"sync", {"sync"}}, {"power", {"power"}}, {"led", {"led"}}};
std::mutex lines_mutex;

}  // namespace
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

extern "C" {

gpiod_chip* gpiod_chip_open(const char* /*path*/) {
  errno = ENOENT;
  return nullptr;
}
void gpiod_chip_close(gpiod_chip* /*chip*/) {}
gpiod_line* gpiod_chip_get_line(gpiod_chip* /*chip*/, unsigned int /*offset*/) { return nullptr; }

gpiod_line* gpiod_line_find(const char* name) {
  const auto found = lines_of_the_board.find(name);
  return found == lines_of_the_board.end() ? nullptr : &found->second;
}
void gpiod_line_close_chip(gpiod_line* line) {
  for (int& end : line->edges) {
    ::close(end);
    end = -1;
  }
}

// Two edges up and one down wait on every input.
int gpiod_line_request_both_edges_events_flags(gpiod_line* line, const char* /*consumer*/, int /*flags*/) {
  if (::pipe2(line->edges.data(), O_CLOEXEC) != 0) {
    return -1;
  }
  for (const int type : {GPIOD_LINE_EVENT_RISING_EDGE, GPIOD_LINE_EVENT_FALLING_EDGE, GPIOD_LINE_EVENT_RISING_EDGE}) {
    const gpiod_line_event event{.ts = {.tv_sec = 1000, .tv_nsec = 0}, .event_type = type};
    static_cast<void>(::write(line->edges[1], &event, sizeof(event)));
  }
  return 0;
}
int gpiod_line_request_output(gpiod_line* line, const char* /*consumer*/, int value) {
  return gpiod_line_set_value(line, value);
}
int gpiod_line_event_get_fd(gpiod_line* line) { return line->edges[0]; }
int gpiod_line_event_read_fd(int descriptor, gpiod_line_event* event) {
  return ::read(descriptor, event, sizeof(*event)) == sizeof(*event) ? 0 : -1;
}
int gpiod_line_get_value(gpiod_line* /*line*/) { return 1; }
int gpiod_line_set_value(gpiod_line* line, int value) {
  const std::lock_guard lock(lines_mutex);
  if (line->levels.empty() || line->levels.back().second != value) {
    line->levels.emplace_back(odoless::MonotonicClock().now_ns(), value);
  }
  return 0;
}
}

namespace odoless::test {
namespace {

using test::kMs;

std::string how_it_is_scheduled() {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    sched_param scheduling{};
    if (content_of(entry.path() / "comm") == "odo-gpio\n" &&
        sched_getparam(std::stoi(entry.path().filename()), &scheduling) == 0) {
      return fmt::format("priority {}\n", scheduling.sched_priority);
    }
  }
  return "no thread\n";
}

/// What is on the lines within 1.5 s without a scan. All inputs are high.
std::string served(const DaemonParams& params) {
  for (auto& [name, line] : lines_of_the_board) {
    line.levels.clear();
  }
  GpioSignals signals;
  const MonotonicClock clock;
  const WakeUp wake;
  Outbox outbox(1 << 16);
  const std::int64_t end_ns = clock.now_ns() + 1500 * kMs;
  std::string text;
  {
    GpioThread thread(params.gpio, signals, clock, wake, outbox);
    EXPECT_EQ(thread.start(), 0);
    text += how_it_is_scheduled();
    sleep_ns(end_ns - clock.now_ns());
    int pulses = 0;
    for (std::int64_t pulse_ns = 0; signals.sync_pulses_ns.try_pop(pulse_ns);) {
      ++pulses;
    }
    text += fmt::format("stopped {}, lost {}, {} pulses\n", signals.stopped.load(), signals.line_lost.load(), pulses);
  }
  for (const auto& [at_ns, level] : lines_of_the_board.at("power").levels) {
    text += at_ns < end_ns ? fmt::format("power {}\n", level) : "";
  }
  const auto& light = lines_of_the_board.at("led").levels;
  return text + fmt::format("light in the end {}\n", light.empty() ? -1 : light.back().second);
}

std::vector<Scene> all_gpio_scenes() {
  const std::string all =
      "[gpio]\nstop_line = \"stop\"\nsync_line = \"sync\"\npower_line = \"power\"\n"
      "led_line = \"led\"\npower_cycle_after_ms = 1000\npower_off_ms = 100\n";
  return {{"served", {all}, served}};
}

}  // namespace

KeyClass gpio_class() { return {"gpio", {"gpio."}, all_gpio_scenes, lack_of_real_time}; }

}  // namespace odoless::test
