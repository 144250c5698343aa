#include "firmware/sources/lcm_source.hpp"

#include <utility>

namespace odoless {
LcmSource::LcmSource(const LcmParams& params, const std::string& scan_channel, int beams_max)
    : LcmSource(params, Names{.scan = scan_channel, .scan_times = times_channel(scan_channel)}, beams_max) {}

LcmSource::LcmSource(const LcmParams& params, const Channels& channels, int beams_max)
    : LcmSource(params,
                Names{channels.scan, channels.scan_times, channels.scan_again, channels.motion, channels.motion_again},
                beams_max) {}

// An unused name is empty, as no message's channel is.
LcmSource::LcmSource(const LcmParams& params, Names names, int beams_max)
    : names_(std::move(names)),
      receiver_(params, {names_.scan, names_.scan_times, names_.scan_again, names_.motion, names_.motion_again}),
      ranges_m_(static_cast<std::size_t>(beams_max)) {}

void LcmSource::work(const Clock& /*clock*/, ScanSink& sink) {
  for (int i = 0; i < kMessagesPerRound; ++i) {
    const std::optional<LcmMessage> message = receiver_.try_receive();
    if (!message) {
      return;
    }
    if (message->channel == names_.scan_times) {
      take_scan_times(*message);
    } else if (message->channel == names_.scan || message->channel == names_.scan_again) {
      take_scan(*message, sink);
    } else {
      take_motion(*message, sink);
    }
  }
}

void LcmSource::take_scan(const LcmMessage& message, ScanSink& sink) {
  const Result<RawScan> decoded = decode_scan(message.payload, ranges_m_);
  if (!decoded.ok()) {
    ++refused_;
    return;
  }
  RawScan scan = decoded.value();
  if (message.channel == names_.scan || scan.stamp_ns > last_scan_ns_) {
    last_scan_ns_ = scan.stamp_ns;
    scan.first_beam_ns = times_.first_beam_ns;
    scan.beam_period_ns = times_.beam_period_ns;
    sink.on_scan(scan);
  }
}

void LcmSource::take_scan_times(const LcmMessage& message) {
  if (const Result<ScanTimes> times = decode_scan_times(message.payload); times.ok()) {
    times_ = times.value();
  } else {
    ++refused_;
  }
}

void LcmSource::take_motion(const LcmMessage& message, ScanSink& sink) {
  const Result<Motion> motion = decode_motion(message.payload);
  if (!motion.ok()) {
    ++motions_refused_;
  } else if (message.channel == names_.motion || motion.value().to_stamp_ns > last_motion_ns_) {
    last_motion_ns_ = motion.value().to_stamp_ns;
    sink.on_motion(motion.value());
  }
}

void LcmSource::add_counts(SourceHealth& health) const {
  const LcmReceiverCounters& counters = receiver_.counters();
  health.rejected += refused_ + counters.malformed + counters.fragments;
  health.motions_refused += motions_refused_;
  health.datagrams_lost += counters.lost;
  health.forged += counters.forged;
  health.replayed += counters.replayed;
}

}  // namespace odoless
