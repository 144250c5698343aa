#include "drivers/lrf/ydlidar/bring_up.hpp"

#include <algorithm>
#include <array>

namespace odoless::ydlidar {
namespace {

constexpr std::int64_t kListenNs = 150'000'000;  ///< ten packets of the slowest
constexpr std::int64_t kSpinUpNs = 4'000'000'000;
constexpr std::array kRatesBaud{128000, 115200, 230400, 512000};

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : BringUpSteps(params, stream), rate_(params, kRatesBaud) {}

void BringUp::start(std::int64_t now_ns, bool /*with_reset*/) {
  begin();
  enter(Step::kListen, now_ns);
}

void BringUp::enter(Step step, std::int64_t now_ns) {
  matched_ = 0;
  listener_.start();
  wait(step, now_ns + std::max(params().reply_timeout_ns, kListenNs));
  if (step == Step::kStart) {
    send(kScanRequest);
  }
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  if (step() == Step::kListen) {
    return enter(Step::kStart, now_ns);
  }
  if (step() == Step::kStart && rate_.next()) {
    tell_silence(sink);
  }
  enter(Step::kListen, now_ns);
}

// Its motor may have to begin to turn.
void BringUp::look_for_answer(std::span<const std::byte> bytes, std::int64_t now_ns) {
  for (const std::byte byte : bytes) {
    matched_ = byte == kScanAnswer[matched_] ? matched_ + 1 : byte == kScanAnswer[0] ? 1 : 0;
    if (matched_ == kScanAnswer.size()) {
      matched_ = 0;
      wait(Step::kStart, now_ns + kSpinUpNs);
    }
  }
}

void BringUp::receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink) {
  if (step() == Step::kPause) {
    bytes = {};
    return;
  }
  if (step() == Step::kStart) {
    look_for_answer(bytes, now_ns);
  }
  if (listener_.hears(bytes)) {
    if (const Errc error = stream().configure(rate_.baud()); error != Errc::kOk) {
      return refuse(error, now_ns, sink);
    }
    rate_.found();
    finish();
  }
}

}  // namespace odoless::ydlidar
