// No laser's session uses the heap once it is made: while it is brought up, streams, is given garbage, and comes back.
#include <gtest/gtest.h>

#include "tests/drivers/lrf/tested_lasers.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless {
namespace {

using test::kMs;
using test::kSecond;

/// Counts, and allocates nothing.
class Counter final : public LrfSink {
 public:
  void on_scan(const LrfScan&) override { ++scans; }
  void on_event(const LrfEvent&) override { ++events; }
  int scans = 0;
  int events = 0;
};

class LrfAllocation : public ::testing::TestWithParam<test::TestedLaser> {};

TEST_P(LrfAllocation, NothingIsAllocatedAfterConstruction) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer has malloc; the released build runs this";
  }
  WorldSource source(test::period_ns_of(GetParam().model), test::small_drive());
  const auto device = make_emulated_lrf(
      GetParam().model, source,
      {.faults = {parse_fault("garbage@1:0.5"), parse_fault("wrong-sum@2:0.5"), parse_fault("reboot@3:0.3")}}, 0);
  const auto session = make_lrf_session(GetParam().params(), 2048);
  Counter counter;
  std::int64_t calls = 0;
  session->reset(0);
  for (std::int64_t now_ns = 0; now_ns < 12 * kSecond; now_ns += kMs) {
    device->tick(now_ns);
    const std::vector<SentBytes> sent = device->take_output();
    const AllocationGuard guard;
    for (const SentBytes& piece : sent) {
      session->receive(std::as_bytes(std::span(piece.bytes.data(), piece.bytes.size())), now_ns, counter);
    }
    session->tick(now_ns, counter);
    const auto request = session->transmit();
    calls += guard.calls();
    device->set_line_baud(session->line_baud());
    device->receive({reinterpret_cast<const char*>(request.data()), request.size()}, now_ns);
  }
  EXPECT_EQ(calls, 0);
  EXPECT_TRUE(session->ready());
  EXPECT_GT(counter.scans, 10);
  EXPECT_GT(counter.events, 3) << "or the faults were not met";
}

INSTANTIATE_TEST_SUITE_P(Lasers, LrfAllocation, ::testing::ValuesIn(test::kTestedLasers),
                         [](const auto& tested) { return test::laser_name(tested); });

}  // namespace
}  // namespace odoless
