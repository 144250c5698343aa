#include "drivers/lrf/ldrobot/bring_up.hpp"

#include <algorithm>
#include <array>

namespace odoless::ldrobot {
namespace {

constexpr std::int64_t kListenNs = 150'000'000;  ///< 50 packets
constexpr std::array<int, 2> kRatesBaud{230400, 921600};

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : BringUpSteps(params, stream), rate_(params, kRatesBaud) {}

void BringUp::start(std::int64_t now_ns, bool /*with_reset*/) {
  begin();
  listen(now_ns);
}

void BringUp::listen(std::int64_t now_ns) {
  listener_.start();
  wait(Step::kListen, now_ns + std::max(params().reply_timeout_ns, kListenNs));
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  if (step() == Step::kListen && rate_.next()) {
    tell_silence(sink);
  }
  listen(now_ns);
}

void BringUp::receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink) {
  if (step() == Step::kPause) {
    bytes = {};
  } else if (listener_.hears(bytes)) {
    if (const Errc error = stream().configure(listener_.packet(), rate_.baud()); error != Errc::kOk) {
      return refuse(error, now_ns, sink);
    }
    rate_.found();
    finish();
  }
}

}  // namespace odoless::ldrobot
