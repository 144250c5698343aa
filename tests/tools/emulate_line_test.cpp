// An emulated laser on a line that takes what it can.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "tests/tools/emulate_support.hpp"
#include "tools/emulate/lrf_emulator.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kStep_ns = 1'000'000;

/// A client that asks once, and then reads or does not.
class ScriptedLine final : public EmulatedLine {
 public:
  explicit ScriptedLine(std::string request) : request_(std::move(request)) {}

  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] std::string path() const override { return "none"; }
  [[nodiscard]] bool has_client() override { return true; }
  [[nodiscard]] std::string read() override { return std::exchange(request_, ""); }
  [[nodiscard]] std::size_t write(std::string_view bytes) override {
    const std::size_t taken = reads ? bytes.size() : 0;
    heard += bytes.substr(0, taken);
    return taken;
  }

  bool reads = true;
  std::string heard;

 private:
  std::string request_;
};

// An express scan of an RPLIDAR: each capsule of some samples is a piece of its own.
const std::string kScan{"\xA5\x82\x05\x01\x00\x00\x00\x00\x23", 9};

struct Emulation {
  std::string heard;
  LrfEmulation done;
};

/// Two seconds of it, run every `step_ns`.
Emulation emulate(std::int64_t step_ns, bool reads) {
  WorldSource source(test::period_ns_of("rplidar-s2"), test::small_drive());
  const std::unique_ptr<EmulatedLrf> device = make_emulated_lrf("rplidar-s2", source, {}, 0);
  ScriptedLine line(kScan);
  LoopedLrf laser(*device, source, line, "", [] {});
  laser.step(0);
  line.reads = reads;
  for (std::int64_t now_ns = step_ns; now_ns <= 2'000'000'000; now_ns += step_ns) {
    laser.step(now_ns);
  }
  return {.heard = line.heard, .done = laser.done()};
}

TEST(EmulatedLrfOnALine, SendsTheSameWhenItIsLate) {
  const Emulation prompt = emulate(kStep_ns, true);
  const Emulation late = emulate(16 * kStep_ns, true);
  EXPECT_GE(prompt.done.scans, 15);
  EXPECT_EQ(late.done.scans, prompt.done.scans);
  EXPECT_EQ(late.done.dropped, 0);
  EXPECT_TRUE(late.heard == prompt.heard) << late.heard.size() << " bytes, not " << prompt.heard.size();
}

TEST(EmulatedLrfOnALine, LeavesOutWhatAClientDoesNotRead) {
  const Emulation unread = emulate(kStep_ns, false);
  EXPECT_EQ(unread.done.scans, 0);
  EXPECT_GE(unread.done.dropped, 10);
}

}  // namespace
}  // namespace odoless
