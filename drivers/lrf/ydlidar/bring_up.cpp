#include "drivers/lrf/ydlidar/bring_up.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace odoless::ydlidar {
namespace {

constexpr int kPacketsWanted = 4;
constexpr std::int64_t kListenNs = 150'000'000;  ///< ten packets of the slowest
constexpr std::int64_t kSpinUpNs = 4'000'000'000;
constexpr std::int64_t kPauseNs = 1'000'000'000;
constexpr std::array kRatesBaud{128000, 115200, 230400, 512000};

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : params_(params), stream_(stream), rate_(params, kRatesBaud) {}

void BringUp::start(std::int64_t now_ns, bool /*with_reset*/) { enter(Step::kListen, now_ns); }

void BringUp::enter(Step step, std::int64_t now_ns) {
  step_ = step;
  packets_ = 0;
  matched_ = 0;
  request_is_due_ = step == Step::kStart;
  reader_.clear();
  deadline_ns_ = now_ns + (step == Step::kRefused ? kPauseNs : std::max(params_.reply_timeout_ns, kListenNs));
}

std::span<const std::byte> BringUp::take_request() {
  return std::exchange(request_is_due_, false) ? std::span<const std::byte>(kScanRequest)
                                               : std::span<const std::byte>();
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  if (step_ == Step::kListen) {
    enter(Step::kStart, now_ns);
    return;
  }
  if (step_ == Step::kStart) {
    if (rate_.next() && !std::exchange(silence_told_, true)) {
      sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceSilent});
    }
  }
  enter(Step::kListen, now_ns);
}

// Its motor may have to begin to turn.
void BringUp::look_for_answer(std::span<const std::byte> bytes, std::int64_t now_ns) {
  for (const std::byte byte : bytes) {
    matched_ = byte == kScanAnswer[matched_] ? matched_ + 1 : byte == kScanAnswer[0] ? 1 : 0;
    if (matched_ == kScanAnswer.size()) {
      matched_ = 0;
      deadline_ns_ = now_ns + kSpinUpNs;
    }
  }
}

void BringUp::on_packet(std::int64_t now_ns, LrfSink& sink) {
  if (++packets_ < kPacketsWanted) {
    return;
  }
  if (const Errc error = stream_.configure(rate_.baud()); error != Errc::kOk) {
    sink.on_event({.type = LrfEventType::kRejected, .reason = error});
    enter(Step::kRefused, now_ns);
    return;
  }
  step_ = Step::kDone;
  rate_.found();
  silence_told_ = false;
}

void BringUp::receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink) {
  if (step_ == Step::kStart) {
    look_for_answer(bytes, now_ns);
  }
  while (!bytes.empty() && !done()) {
    if (step_ == Step::kRefused) {
      bytes = {};
      return;
    }
    switch (reader_.take(bytes)) {
      case PacketReader::Outcome::kMore:
        return;
      case PacketReader::Outcome::kSkipped:
      case PacketReader::Outcome::kWrongSum:
        packets_ = 0;
        break;
      case PacketReader::Outcome::kPacket:
        on_packet(now_ns, sink);
        break;
    }
  }
}

}  // namespace odoless::ydlidar
