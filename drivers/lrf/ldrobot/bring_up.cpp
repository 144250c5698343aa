#include "drivers/lrf/ldrobot/bring_up.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace odoless::ldrobot {
namespace {

constexpr int kPacketsWanted = 4;
constexpr std::int64_t kListenNs = 150'000'000;  ///< 50 packets
constexpr std::int64_t kPauseNs = 1'000'000'000;
constexpr std::array<int, 2> kRatesBaud{230400, 921600};

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : params_(params), stream_(stream), rate_(params, kRatesBaud) {}

void BringUp::start(std::int64_t now_ns, bool /*with_reset*/) { listen(now_ns); }

void BringUp::listen(std::int64_t now_ns) {
  is_done_ = is_refused_ = false;
  packets_ = 0;
  reader_.clear();
  deadline_ns_ = now_ns + std::max(params_.reply_timeout_ns, kListenNs);
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  if (!is_refused_) {
    if (rate_.next() && !std::exchange(silence_told_, true)) {
      sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceSilent});
    }
  }
  listen(now_ns);
}

void BringUp::receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink) {
  while (!bytes.empty() && !is_done_) {
    if (is_refused_) {
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
        if (++packets_ < kPacketsWanted) {
          break;
        }
        if (const Errc error = stream_.configure(reader_.packet(), rate_.baud()); error != Errc::kOk) {
          sink.on_event({.type = LrfEventType::kRejected, .reason = error});
          is_refused_ = true;
          deadline_ns_ = now_ns + kPauseNs;
          break;
        }
        is_done_ = true;
        rate_.found();
        silence_told_ = false;
        break;
    }
  }
}

}  // namespace odoless::ldrobot
