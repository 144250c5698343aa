// Whatever a laser's line carries, at whatever times: the session neither crashes nor spins, and what it passes on is
// whole. Fed with real answers first, so that the stream is reached: the input's bytes come between and instead of
// them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/check.hpp"
#include "tests/tools/emulate_support.hpp"
#include "tools/emulate/scip_text.hpp"

namespace {

using odoless::LrfEvent;
using odoless::LrfScan;

/// What an owner relies on.
class Contract final : public odoless::LrfSink {
 public:
  explicit Contract(const odoless::LrfSession& session) : session_(session) {}

  void on_scan(const LrfScan& scan) override {
    ODOLESS_CHECK(static_cast<int>(scan.ranges_m.size()) == session_.geometry().beams);
    ODOLESS_CHECK(scan.stamp_ns > last_stamp_ns_ && scan.stamp_ns % 1000 == 0);
    ODOLESS_CHECK(std::isfinite(scan.start_angle_rad) && scan.angle_step_rad > 0.0);
    for (const float range_m : scan.ranges_m) {
      ODOLESS_CHECK(range_m >= 0.0F);
    }
    last_stamp_ns_ = scan.stamp_ns;
  }
  void on_event(const LrfEvent&) override {}

 private:
  const odoless::LrfSession& session_;
  std::int64_t last_stamp_ns_ = 0;
};

void give(odoless::LrfSession& session, std::string_view bytes, std::int64_t now_ns, odoless::LrfSink& sink) {
  session.receive(std::as_bytes(std::span(bytes.data(), bytes.size())), now_ns, sink);
}

/// A device's answers by request and the scans of its stream, made once: the input is the session's, not the device's.
class Device {
 public:
  Device() {
    odoless::test::Bench bench("urg-04lx");
    std::size_t asked = 0;
    bench.on_the_way = [&](std::string& bytes) {
      if (bench.session().ready()) {
        scans_.push_back(bytes);
      } else {
        answers_[bench.written().substr(asked)] += bytes;
        asked = bench.written().size();
      }
    };
    bench.reset();
    bench.run(8 * odoless::test::kSecond);
    answers_["RS\n"] = odoless::scip::answer("RS", "00");
    answers_["TM2\n"] = odoless::scip::answer("TM2", "00");
    answers_["QT\n"] = odoless::scip::answer("QT", "00");
  }

  [[nodiscard]] std::string_view answer(std::string_view request) const {
    const auto found = answers_.find(std::string(request));
    return found == answers_.end() ? std::string_view() : found->second;
  }
  [[nodiscard]] std::string_view scan(std::size_t index) const { return scans_[index % scans_.size()]; }

 private:
  std::map<std::string, std::string> answers_;
  std::vector<std::string> scans_;
};

}  // namespace

// Each piece of the input: a byte that says how long it is and whether the device's own bytes come too, and the piece.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Device device;
  constexpr int kScanSteps = 5;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::int64_t now_ns = odoless::test::kSecond;
  const auto session = odoless::make_lrf_session({}, 700);
  Contract contract(*session);
  session->reset(now_ns);
  for (int step = 0; step < 60 || !rest.empty(); ++step) {
    now_ns += 20 * odoless::test::kMs;
    const auto bytes = session->transmit();
    const std::string_view request(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const bool injects = (session->ready() || step > 30) && !rest.empty();
    const auto head = injects ? static_cast<std::uint8_t>(rest.front()) : std::uint8_t{0};
    if (head < 128) {
      give(*session, device.answer(request), now_ns, contract);
      if (session->ready() && step % kScanSteps == 0) {
        give(*session, device.scan(static_cast<std::size_t>(step / kScanSteps)), now_ns, contract);
      }
    }
    if (injects) {
      rest.remove_prefix(1);
      give(*session, rest.substr(0, head % 128U), now_ns, contract);
      rest.remove_prefix(std::min<std::size_t>(rest.size(), head % 128U));
    }
    session->tick(now_ns, contract);
    ODOLESS_CHECK(session->next_deadline_ns() > now_ns);
  }
  ODOLESS_CHECK(size > 0 || session->counters().scans > 0);  // or nothing of the stream is tested
  return 0;
}
