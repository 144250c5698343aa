// Whatever bytes a Dynamixel's line carries, at whatever times: the session neither crashes nor spins, and what it
// passes on is in order. Each piece of the input: how many milliseconds pass, how many bytes follow, what is told to
// the session and whether the servo's own answers come through; and the bytes.
#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"
#include "tests/tools/servo_support.hpp"

namespace {

/// What an owner relies on.
class Contract final : public odoless::TiltSink {
 public:
  void on_angle(const odoless::TiltSample& sample) override {
    ODOLESS_CHECK(sample.stamp_ns > last_stamp_ns_ && std::isfinite(sample.angle_rad));
    last_stamp_ns_ = sample.stamp_ns;
  }
  void on_event(const odoless::TiltEvent&) override {}

 private:
  std::int64_t last_stamp_ns_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const odoless::TiltParams params = odoless::test::servo_params(odoless::TiltDriver::kDynamixel);
  const auto servo = odoless::test::ServoBench::make_servo(params, {});
  const auto session = odoless::make_tilt_session(params);
  Contract contract;
  std::int64_t now_ns = 1000 * odoless::test::kServoSecond;
  bool hears = true;
  const auto step = [&] {
    now_ns += odoless::test::kServoMs;
    servo->tick(now_ns);
    for (const odoless::ServoFrame& frame : servo->take_output()) {
      if (hears) {
        session->receive(frame, now_ns, contract);
      }
    }
    session->tick(now_ns, contract);
    int packets = 0;
    for (auto bytes = session->transmit(); !bytes.empty(); bytes = session->transmit()) {
      servo->receive(bytes, now_ns);
      ODOLESS_CHECK(++packets <= 1);
    }
    ODOLESS_CHECK(session->next_deadline_ns() > now_ns);
  };
  session->reset(now_ns);
  for (int i = 0; i < 150; ++i) {
    step();
  }
  ODOLESS_CHECK(session->counters().samples > 0);  // or nothing beyond the bring-up is tested
  std::size_t pieces = 0;
  for (std::size_t at = 0; at + 3 <= size && pieces < 400; ++pieces) {
    for (int ms = data[at] % 64; ms >= 0; --ms) {
      step();
    }
    const std::size_t count = std::min<std::size_t>(data[at + 1], size - at - 3);
    hears = data[at + 2] % 8 != 0;
    session->command(static_cast<odoless::TiltCommand>(data[at + 2] / 8 % 3), now_ns);
    session->receive(std::as_bytes(std::span(data + at + 3, count)), now_ns, contract);
    at += 3 + count;
  }
  for (int i = 0; i < 20; ++i) {
    step();
  }
  return 0;
}
