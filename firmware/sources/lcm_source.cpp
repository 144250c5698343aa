#include "firmware/sources/lcm_source.hpp"

#include <utility>

#include "firmware/lcm/decode.hpp"

namespace odoless {
namespace {

std::vector<std::string> wanted(const std::string& scan_channel, const std::string& motion_channel) {
  std::vector<std::string> channels{scan_channel};
  if (!motion_channel.empty()) {
    channels.push_back(motion_channel);
  }
  return channels;
}

}  // namespace

LcmSource::LcmSource(const LcmParams& params, std::string scan_channel, std::string motion_channel, int beams_max)
    : scan_channel_(std::move(scan_channel)),
      motion_channel_(std::move(motion_channel)),
      receiver_(params, wanted(scan_channel_, motion_channel_)),
      ranges_m_(static_cast<std::size_t>(beams_max)) {}

void LcmSource::work(std::int64_t /*now_ns*/, ScanSink& sink) {
  for (int i = 0; i < kMessagesPerRound; ++i) {
    const std::optional<LcmMessage> message = receiver_.try_receive();
    if (!message) {
      return;
    }
    if (message->channel == scan_channel_) {
      const Result<RawScan> scan = decode_scan(message->payload, ranges_m_);
      scan.ok() ? sink.on_scan(scan.value()) : void(++refused_);
    } else {
      const Result<MotionRecord> motion = decode_motion(message->payload);
      motion.ok() ? sink.on_motion(motion.value()) : void(++refused_);
    }
  }
}

void LcmSource::add_counts(SourceHealth& health) const {
  const LcmReceiverCounters& counters = receiver_.counters();
  health.rejected += refused_ + counters.malformed + counters.fragments;
  health.datagrams_lost += counters.lost;
}

}  // namespace odoless
