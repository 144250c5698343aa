// Whatever frames a CAN bus carries, at whatever times: the session neither crashes nor spins, and what it passes on is
// in order. Each 18 bytes of the input are one frame, put between those of an emulated drive: how many milliseconds
// pass before it, its bytes, and whether the drive's own answers come through until the next.
#include <cmath>
#include <cstring>

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
  constexpr std::size_t kPieceBytes = 18;
  constexpr std::size_t kPiecesMax = 400;
  const odoless::TiltParams params = odoless::test::servo_params(odoless::TiltDriver::kCia402);
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
    int frames = 0;
    for (auto bytes = session->transmit(); !bytes.empty(); bytes = session->transmit()) {
      servo->receive(bytes, now_ns);
      ODOLESS_CHECK(++frames <= 16);
    }
    ODOLESS_CHECK(session->next_deadline_ns() > now_ns);
  };
  session->reset(now_ns);
  for (int i = 0; i < 150; ++i) {
    step();
  }
  ODOLESS_CHECK(session->counters().samples > 0);  // or nothing beyond the bring-up is tested
  for (std::size_t at = 0; at + kPieceBytes <= size && at < kPiecesMax * kPieceBytes; at += kPieceBytes) {
    for (int ms = data[at] % 32; ms >= 0; --ms) {
      step();
    }
    session->receive(std::as_bytes(std::span(data + at + 1, 16)), now_ns, contract);
    hears = data[at + 17] % 8 != 0;
    session->command(static_cast<odoless::TiltCommand>(data[at + 17] / 8 % 3), now_ns);
  }
  for (int i = 0; i < 20; ++i) {
    step();
  }
  return 0;
}
