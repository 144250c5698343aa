// Whatever a client says to an emulated device, and whenever: it neither breaks nor floods its line, and is as new
// after its power was off. The input: which device, and pieces of bytes, each with its length and the time before it.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/fuzz/codec_fuzz.hpp"
#include "tests/fuzz/lrf_session_fuzz.hpp"
#include "tools/emulate/cia402_device.hpp"
#include "tools/emulate/dynamixel_device.hpp"
#include "tools/emulate/maestro_device.hpp"

namespace {

using odoless::test::FuzzInput;
using odoless::test::kMs;
using odoless::test::kSecond;

constexpr std::size_t kServos = 3;
constexpr std::size_t kAtOnceMaxBytes = 1 << 20;

std::string_view text_of(std::span<const std::uint8_t> piece) {
  return {reinterpret_cast<const char*>(piece.data()), piece.size()};
}

/// Up to a quarter of a second.
std::int64_t pause_ns(std::uint8_t byte) { return byte * kMs; }

void fuzz_laser(const std::string& model, FuzzInput input) {
  odoless::test::RoundRoom source(odoless::test::period_ns_of(model));
  std::int64_t now_ns = 1000 * kSecond;
  const auto device = odoless::make_emulated_lrf(model, source, {}, now_ns);
  const auto take = [&] {
    std::size_t bytes = 0;
    for (const odoless::SentBytes& sent : device->take_output()) {
      bytes += sent.bytes.size();
    }
    ODOLESS_CHECK(bytes < kAtOnceMaxBytes);
  };
  while (!input.empty()) {
    now_ns += pause_ns(input.byte());
    device->tick(now_ns);
    take();
    device->receive(text_of(input.piece()), now_ns);
    take();
  }
  device->set_power(false, now_ns);
  device->tick(now_ns += kSecond);
  take();
  device->set_power(true, now_ns);
  device->tick(now_ns += kSecond);
  take();
}

void fuzz_servo(odoless::EmulatedServo& servo, bool is_can, FuzzInput input) {
  std::int64_t now_ns = 1000 * kSecond;
  while (!input.empty()) {
    now_ns += pause_ns(input.byte());
    servo.tick(now_ns);
    if (is_can) {
      odoless::CanFrame frame;
      const std::uint8_t head = input.byte();
      frame.id = (head & 0xF0U) << 3U | (head & 0x0FU);  // function and node
      const auto data = input.take(8);
      frame.size_bytes = static_cast<std::uint8_t>(data.size());
      std::copy(data.begin(), data.end(), frame.data.begin());
      servo.receive(odoless::as_bytes(frame), now_ns);
    } else {
      servo.receive(std::as_bytes(input.piece()), now_ns);
    }
    std::size_t bytes = 0;
    for (const odoless::ServoFrame& frame : servo.take_output()) {
      bytes += frame.size();
    }
    ODOLESS_CHECK(bytes < kAtOnceMaxBytes);
    ODOLESS_CHECK(std::isfinite(servo.angle_rad()) && std::isfinite(servo.velocity_radps()));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<odoless::EmulatedLrfModel> models = odoless::emulated_lrf_models();
  FuzzInput input(data, size);
  const std::size_t which = input.byte() % (models.size() + kServos);
  if (which >= kServos) {
    fuzz_laser(models[which - kServos].name, input);
    return 0;
  }
  constexpr std::int64_t kStartNs = 1000 * kSecond;
  const std::unique_ptr<odoless::EmulatedServo> servos[kServos] = {
      std::make_unique<odoless::Cia402Device>(odoless::Cia402DeviceOptions{}, kStartNs),
      std::make_unique<odoless::DynamixelDevice>(odoless::DynamixelDeviceOptions{}, kStartNs),
      std::make_unique<odoless::MaestroDevice>(odoless::MaestroDeviceOptions{}, kStartNs)};
  fuzz_servo(*servos[which], which == 0, input);
  return 0;
}
