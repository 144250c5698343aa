#include "tools/emulate/traced_servo.hpp"

#include <utility>

namespace odoless {
namespace {

constexpr std::int64_t kGapMax_ns = 10'000'000'000;

}  // namespace

TracedServo::TracedServo(std::unique_ptr<EmulatedServo> servo)
    : servo_(std::move(servo)), angles_rad_(kSamples, kGapMax_ns) {}

void TracedServo::receive(std::span<const std::byte> bytes, std::int64_t now_ns) {
  servo_->receive(bytes, now_ns);
  note(now_ns);
}

void TracedServo::tick(std::int64_t now_ns) {
  servo_->tick(now_ns);
  note(now_ns);
}

void TracedServo::note(std::int64_t now_ns) { static_cast<void>(angles_rad_.add(now_ns, servo_->angle_rad())); }

double TracedServo::angle_rad_at(std::int64_t time_ns) {
  if (angles_rad_.at(time_ns).error() == Errc::kNotYet) {
    tick(time_ns);
  }
  const Result<double> angle_rad = angles_rad_.at(time_ns);
  return angle_rad.ok() ? angle_rad.value() : servo_->angle_rad();
}

}  // namespace odoless
