#pragma once

#include <lcm/lcm.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/graph/map_correction.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "firmware/lcm/authentication.hpp"
#include "firmware/lcm/channels.hpp"
#include "firmware/lcm/deflater.hpp"
#include "firmware/lcm/lcm_params.hpp"
#include "firmware/lcm/map_view.hpp"
#include "firmware/records/cloud_piece.hpp"
#include "firmware/records/health.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// Gets every encoded message, sent or not: the recorder.
class LcmTap {
 public:
  LcmTap() = default;
  LcmTap(const LcmTap&) = delete;
  LcmTap& operator=(const LcmTap&) = delete;
  virtual ~LcmTap() = default;

  /// `message` is encoded, with its fingerprint, and lives as long as the call.
  /// @param stamp_ns  When it was published, on the wall clock, whatever clock its own stamps are of.
  virtual void record(std::string_view channel, std::span<const std::byte> message, std::int64_t stamp_ns) = 0;
};

/// Since construction.
struct LcmCounters {
  std::int64_t messages = 0;  ///< sent
  std::int64_t bytes = 0;     ///< of them
  std::int64_t errors = 0;    ///< the system refused to send
  std::int64_t too_long = 0;  ///< refused before, being longer than `kMessageMaxBytes`
};

/// Publishes records over LCM.
///
/// Each `publish` converts, encodes into a buffer that exists already, hands the message to the tap and sends it.
/// Nothing is allocated after the first message of a kind. An error is counted and returned, and stops nothing: the
/// next message is tried again. None is longer than `kMessageMaxBytes`, so that each fits one datagram. With
/// `LcmParams::key_file` a trailer (authentication.hpp) follows scans and motions, though not to the tap.
///
/// Thread: publisher thread only, as sending may block on a full socket; never a real-time thread.
class LcmLink {
 public:
  /// @param map_cells_max  Most cells of a whole map; memory for half of them is set aside.
  LcmLink(const LcmParams& params, std::size_t map_cells_max);
  ~LcmLink();
  LcmLink(const LcmLink&) = delete;
  LcmLink& operator=(const LcmLink&) = delete;

  /// Reads the key, if there is one, and opens LCM; may be tried again. With an empty address nothing is opened, and
  /// messages go to the tap alone. Errc::kBadAddress, also of the key's file, or Errc::kUnavailable; `reason` then says
  /// more.
  [[nodiscard]] Errc open();
  /// Why `open` failed, for a person: what is wrong and what would be right.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  [[nodiscard]] bool is_open() const { return lcm_ != nullptr; }

  /// The tap outlives the link, or is taken off by nullptr.
  void set_tap(LcmTap* tap) { tap_ = tap; }
  /// Which laser LRF_STATUS tells of; kLcm until then: nobody knows.
  void set_laser(LrfDriver laser) { laser_ = laser; }

  /// Of all: Errc::kOk, Errc::kTooLong, or Errc::kUnavailable when it was not sent.
  [[nodiscard]] Errc publish(const ScanRecord& scan, std::span<const float> ranges_m);
  /// To the tap alone unless the parameters say otherwise.
  [[nodiscard]] Errc publish(const RawBytesRecord& raw, std::span<const std::byte> bytes);
  [[nodiscard]] Errc publish(const TiltRecord& tilt);
  [[nodiscard]] Errc publish(const Motion& motion);
  /// Three messages: pose, pose with covariance, and where odom is in the map. The velocity is that of the last motion
  /// published, if that ended not more than a second from this pose.
  [[nodiscard]] Errc publish(const PoseRecord& pose);
  [[nodiscard]] Errc publish(const MapCorrection& correction);
  [[nodiscard]] Errc publish(const MapTileRecord& tile, std::span<const std::uint8_t> cells);
  /// Health, that of the 3D map where there is one, and that the laser lives.
  [[nodiscard]] Errc publish(const HealthReport& health);
  /// The whole map; its resolution is halved until it fits one message.
  [[nodiscard]] Errc publish(const MapView& map);
  /// The returns of a scan in the map, if the parameters want them. `pose` is that of the scan.
  [[nodiscard]] Errc publish_points(const PoseRecord& pose, const ScanRecord& scan, std::span<const float> ranges_m);
  /// A piece of the 3D map of at most kCloudPointsMax points.
  [[nodiscard]] Errc publish(const CloudPiece& piece);

  /// From now on every scan and every motion goes out 1 + 2 `LcmParams::send_again` times before the next of its kind:
  /// as itself, and on the channels `scan_again` and `motion_again` before whatever of both comes next, so that a short
  /// failure of the line does not meet all of them. Not to the tap.
  void send_again();

  [[nodiscard]] const LcmCounters& counters() const { return counters_; }
  [[nodiscard]] const Channels& channels() const { return channels_; }

 private:
  struct Messages;
  /// The last message of a kind.
  struct Last {
    std::string again_channel;
    std::vector<std::byte> message{};
    int times_left = 0;
  };
  struct Closer {
    void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
  };
  [[nodiscard]] Errc fail(Errc error, std::string reason);
  template <class Message>
  [[nodiscard]] Errc send(const std::string& channel, const Message& message, bool to_tap_alone = false);
  template <class Message>
  [[nodiscard]] Errc send_and_keep(const std::string& channel, const Message& message, Last& last);
  void send_again(Last& last, int times);
  [[nodiscard]] Errc refuse_too_long();
  [[nodiscard]] const std::string& raw_channel(RawLine line, bool to_device) const;
  [[nodiscard]] Errc transmit(const std::string& channel, std::span<const std::byte> message);
  [[nodiscard]] std::span<const std::byte> signed_message(const std::string& channel,
                                                          std::span<const std::byte> message);

  LcmParams params_;
  Channels channels_;
  std::unique_ptr<Messages> messages_;
  std::unique_ptr<lcm_t, Closer> lcm_;
  std::string reason_;
  LcmTap* tap_ = nullptr;
  LrfDriver laser_ = LrfDriver::kLcm;
  Deflater deflater_;
  std::vector<std::byte> buffer_;
  std::optional<MessageSigner> signer_;
  std::vector<std::byte> signed_;
  std::vector<std::uint8_t> halved_cells_;
  bool sends_again_ = false;
  Last last_scan_message_;
  Last last_motion_message_;
  Motion last_motion_;
  std::int32_t tiles_sent_ = 0;
  LcmCounters counters_;
};

}  // namespace odoless
