#include "firmware/threads/sensor_loop.hpp"

#include <poll.h>

#include <algorithm>
#include <array>

namespace odoless {

SensorLoop::SensorLoop(Pipeline& pipeline, ScanSource& source, Intake& intake, const Clock& clock,
                       std::int64_t budget_ns)
    : pipeline_(pipeline), source_(source), intake_(intake), clock_(clock), timer_(budget_ns) {}

void SensorLoop::run() {
  while (!pipeline_.stopping.load(std::memory_order_acquire) && !source_.is_exhausted()) {
    if (pipeline_.lossless && !intake_.has_room()) {
      sleep_ns(kRoomWait_ns);
    } else {
      wait();
      timer_.begin();
      source_.work(clock_, intake_);
      if (tilt_ != nullptr) {
        tilt_->work(clock_, intake_);
      }
      timer_.end(report_);
      meter_.read(report_);
      intake_.report(source_, tilt_ != nullptr ? tilt_->report() : TiltReport{}, report_);
    }
    pipeline_.sensor.heartbeat.fetch_add(1, std::memory_order_relaxed);
  }
  pipeline_.sensor.done.store(true, std::memory_order_release);
  pipeline_.matcher.wake.notify();
  pipeline_.filter.wake.notify();
  if (tilt_ != nullptr) {
    end_tilt();
  }
}

// The others drain meanwhile.
void SensorLoop::end_tilt() {
  const std::int64_t end_ns = clock_.now_ns() + kTiltEnd_ns;
  tilt_->end(clock_.now_ns());
  tilt_->work(clock_, intake_);
  while (!tilt_->has_ended() && clock_.now_ns() < end_ns) {
    const std::int64_t wake_ns = std::min(tilt_->next_deadline_ns(), end_ns);
    const timespec timeout{.tv_sec = 0, .tv_nsec = std::clamp<std::int64_t>(wake_ns - clock_.now_ns(), 0, kTiltEnd_ns)};
    pollfd ready{.fd = tilt_->descriptor(), .events = POLLIN, .revents = 0};
    static_cast<void>(ppoll(&ready, 1, &timeout, nullptr));
    tilt_->work(clock_, intake_);
  }
}

void SensorLoop::wait() {
  const std::int64_t tilt_deadline_ns = tilt_ != nullptr ? tilt_->next_deadline_ns() : ScanSource::kNever_ns;
  const std::int64_t left_ns = std::min(source_.next_deadline_ns(), tilt_deadline_ns) - clock_.now_ns();
  const std::int64_t wait_ns = std::clamp<std::int64_t>(left_ns, 0, kIdle_ns);
  std::array<pollfd, 3> ready{
      pollfd{.fd = pipeline_.sensor.wake.descriptor(), .events = POLLIN, .revents = 0},
      pollfd{.fd = source_.descriptor(), .events = POLLIN, .revents = 0},
      pollfd{.fd = tilt_ != nullptr ? tilt_->descriptor() : -1, .events = POLLIN, .revents = 0}};
  const timespec timeout{.tv_sec = 0, .tv_nsec = wait_ns};
  static_cast<void>(ppoll(ready.data(), ready.size(), &timeout, nullptr));
  if ((ready[0].revents & POLLIN) != 0) {
    pipeline_.sensor.wake.wait(0);
  }
}

}  // namespace odoless
