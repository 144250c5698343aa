#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/check.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless::test {

/// What the owner of a session relies on.
class SessionContract final : public LrfSink {
 public:
  explicit SessionContract(const LrfSession& session) : session_(session) {}

  void on_scan(const LrfScan& scan) override {
    ODOLESS_CHECK(static_cast<int>(scan.ranges_m.size()) == session_.geometry().beams);
    ODOLESS_CHECK(scan.stamp_ns > last_stamp_ns_ && scan.stamp_ns % 1000 == 0);
    ODOLESS_CHECK(std::isfinite(scan.start_angle_rad) && scan.angle_step_rad != 0.0);
    for (const float range_m : scan.ranges_m) {
      ODOLESS_CHECK(range_m >= 0.0F);
    }
    last_stamp_ns_ = scan.stamp_ns;
  }
  void on_event(const LrfEvent&) override {}

 private:
  const LrfSession& session_;
  std::int64_t last_stamp_ns_ = 0;
};

/// A round room that the robot stands in: what the laser sees is no matter, and must cost nothing.
class RoundRoom final : public EmulatedScans {
 public:
  explicit RoundRoom(std::int64_t period_ns) : period_ns_(period_ns) {}
  [[nodiscard]] std::int64_t start_ns(std::int64_t index) const override { return index * period_ns_; }
  void measure(std::int64_t index, std::span<const EmulatedBeam>, std::span<double> ranges_m) override {
    std::fill(ranges_m.begin(), ranges_m.end(), 2.0 + 0.001 * static_cast<double>(index % 100));
  }
  [[nodiscard]] std::optional<Pose2> world_T_robot(std::int64_t) const override { return {}; }
  [[nodiscard]] std::int64_t duration_ns() const override { return 0; }

 private:
  std::int64_t period_ns_;
};

/// Lets a session talk with an emulated laser, whose bytes the input's come between and instead of, so that the stream
/// is reached. Each piece of the input: a byte that says how long it is and whether the laser's own bytes come too, and
/// the piece.
inline void fuzz_session(const std::string& model, const LrfParams& params, std::string_view rest) {
  const bool is_empty = rest.empty();
  std::int64_t now_ns = 1000 * kSecond;
  RoundRoom source(period_ns_of(model));
  const auto device = make_emulated_lrf(model, source, {}, now_ns);
  const auto session = make_lrf_session(params, 700);
  SessionContract contract(*session);
  const auto give = [&](std::string_view bytes) {
    session->receive(std::as_bytes(std::span(bytes.data(), bytes.size())), now_ns, contract);
  };
  session->reset(now_ns);
  for (int step = 0; step < 100 || (!rest.empty() && step < 2000); ++step) {
    const std::int64_t next_ns = std::min(session->next_deadline_ns(), device->next_event_ns());
    now_ns = std::clamp(next_ns, now_ns + 10 * kMs, now_ns + 100 * kMs);
    device->set_line_baud(session->line_baud());
    const auto request = session->transmit();
    device->receive({reinterpret_cast<const char*>(request.data()), request.size()}, now_ns);
    device->tick(now_ns);
    const bool injects = (session->ready() || step > 30) && !rest.empty();
    const auto head = injects ? static_cast<std::uint8_t>(rest.front()) : std::uint8_t{0};
    for (const SentBytes& sent : device->take_output()) {
      give(head < 128 ? std::string_view(sent.bytes) : std::string_view());
    }
    if (injects) {
      rest.remove_prefix(1);
      give(rest.substr(0, head % 128U));
      rest.remove_prefix(std::min<std::size_t>(rest.size(), head % 128U));
    }
    session->tick(now_ns, contract);
    ODOLESS_CHECK(session->next_deadline_ns() > now_ns);
  }
  ODOLESS_CHECK(!is_empty || session->counters().scans > 0);  // or nothing of the stream is tested
}

}  // namespace odoless::test
