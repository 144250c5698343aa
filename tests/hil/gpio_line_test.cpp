#include "drivers/io/gpio_line.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

namespace fs = std::filesystem;

/// A chip of gpio-sim with four lines, of which 1 is called "odoless-test".
class Chip {
 public:
  Chip() {
    fs::create_directory(folder_);
    fs::create_directory(folder_ / "bank");
    write(folder_ / "bank/num_lines", "4");
    fs::create_directory(folder_ / "bank/line1");
    write(folder_ / "bank/line1/name", "odoless-test");
    write(folder_ / "live", "1");
    name_ = read(folder_ / "bank/chip_name");
    pins_ = fs::path("/sys/devices/platform") / read(folder_ / "dev_name") / name_;
  }
  Chip(const Chip&) = delete;
  Chip& operator=(const Chip&) = delete;
  ~Chip() {
    write(folder_ / "live", "0");
    for (const char* const part : {"bank/line1", "bank", ""}) {
      std::error_code ignored;
      fs::remove(folder_ / part, ignored);
    }
  }

  [[nodiscard]] std::string line(int offset) const { return name_ + ":" + std::to_string(offset); }
  void drive(int offset, bool high) const { write(pin(offset) / "pull", high ? "pull-up" : "pull-down"); }
  [[nodiscard]] std::string value(int offset) const { return read(pin(offset) / "value"); }

 private:
  [[nodiscard]] fs::path pin(int offset) const { return pins_ / ("sim_gpio" + std::to_string(offset)); }
  static void write(const fs::path& path, const char* text) { std::ofstream(path) << text << std::flush; }
  static std::string read(const fs::path& path) {
    std::string word;
    std::ifstream(path) >> word;
    return word;
  }

  fs::path folder_ = "/sys/kernel/config/gpio-sim/line-test";
  std::string name_;
  fs::path pins_;
};

bool is_readable(const GpioLine& line) {
  pollfd ready{.fd = line.descriptor(), .events = POLLIN, .revents = 0};
  return ::poll(&ready, 1, 1000) == 1;
}

TEST(GpioLine, TellsOfEdgesWithTheKernelsStamp) {
  const Chip chip;
  Result<GpioLine> opened = GpioLine::open_input(chip.line(1), GpioPull::kDown);
  ASSERT_TRUE(opened.ok()) << describe(opened.error());
  GpioLine line = opened.take();
  EXPECT_FALSE(line.level().value());
  EXPECT_FALSE(line.read_edge().value().has_value()) << "and doesn't wait for one";
  std::int64_t last_ns = 0;
  for (const bool high : {true, false, true}) {
    const std::int64_t before_ns = monotonic_ns();
    chip.drive(1, high);
    const std::int64_t after_ns = monotonic_ns();
    ASSERT_TRUE(is_readable(line));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // the stamp is that of the edge, not of the reading
    const auto edge = line.read_edge().value();
    ASSERT_TRUE(edge.has_value());
    EXPECT_EQ(edge->high, high);
    EXPECT_EQ(line.level().value(), high);
    EXPECT_GE(edge->monotonic_ns, before_ns);
    EXPECT_LE(edge->monotonic_ns, after_ns + 2'000'000);
    EXPECT_GT(edge->monotonic_ns, last_ns);
    last_ns = edge->monotonic_ns;
  }
}

TEST(GpioLine, IsFoundByItsNameAndHeldByOne) {
  const Chip chip;
  const Result<GpioLine> line = GpioLine::open_input("odoless-test", GpioPull::kUp);
  ASSERT_TRUE(line.ok()) << describe(line.error());
  EXPECT_TRUE(line.value().level().value()) << "pulled up";
  EXPECT_EQ(GpioLine::open_input(chip.line(1), GpioPull::kNone).error(), Errc::kDeviceBusy);
  EXPECT_EQ(GpioLine::open_output("odoless-test", false).error(), Errc::kDeviceBusy);
  EXPECT_EQ(GpioLine::open_input(chip.line(4), GpioPull::kNone).error(), Errc::kDeviceMissing);
}

TEST(GpioLine, DrivesAnOutputFromTheFirstMoment) {
  const Chip chip;
  Result<GpioLine> opened = GpioLine::open_output(chip.line(2), true);
  ASSERT_TRUE(opened.ok());
  GpioLine line = opened.take();
  EXPECT_EQ(chip.value(2), "1");
  EXPECT_EQ(line.set(false), Errc::kOk);
  EXPECT_EQ(chip.value(2), "0");
  EXPECT_EQ(line.set(true), Errc::kOk);
  EXPECT_EQ(chip.value(2), "1");
}

}  // namespace
}  // namespace odoless
