// LCM logs, lcm-logger's and those of the daemon's recorder.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bot_core/joint_state_t.hpp>
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pointcloud_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/raw_t.hpp>
#include <map>
#include <odoless/scan_times_t.hpp>

#include "core/base/result.hpp"
#include "firmware/lcm/channels.hpp"
#include "firmware/lcm/decode.hpp"
#include "tools/log/binary_cursor.hpp"
#include "tools/log/event_log.hpp"
#include "tools/log/formats/formats.hpp"

namespace odoless {
namespace {

struct KnownType {
  std::int64_t fingerprint;
  const char* name;
};

std::string type_of(std::int64_t fingerprint) {
  static const std::array<KnownType, 6> kTypes{{
      {bot_core::planar_lidar_t::getHash(), "bot_core.planar_lidar_t"},
      {bot_core::raw_t::getHash(), "bot_core.raw_t"},
      {bot_core::pose_t::getHash(), "bot_core.pose_t"},
      {bot_core::joint_state_t::getHash(), "bot_core.joint_state_t"},
      {bot_core::pointcloud_t::getHash(), "bot_core.pointcloud_t"},
      {scan_times_t::getHash(), "odoless.scan_times_t"},
  }};
  for (const KnownType& type : kTypes) {
    if (type.fingerprint == fingerprint) {
      return type.name;
    }
  }
  return fmt::format("type 0x{:016x}", static_cast<std::uint64_t>(fingerprint));
}

class LcmLog : public MessageLog {
 public:
  LcmLog(std::unique_ptr<ByteStream> bytes, const std::string& name)
      : MessageLog("LCM log", name), events_(std::move(bytes), name) {}

  [[nodiscard]] std::string advice() const override {
    return has_raw_bytes_ ? fmt::format(
                                "bot_core.planar_lidar_t messages; the devices' raw bytes that it has are played "
                                "to the daemon by `odoless emulate robot --from-raw {}`",
                                name())
                          : "";
  }

  [[nodiscard]] std::string passed_over() const override {
    return events_.lost_bytes() == 0
               ? ""
               : fmt::format("{} bytes that belong to no whole message were passed over", events_.lost_bytes());
  }

 protected:
  bool read(Head& head) override {
    if (!events_.next(event_)) {
      return false;
    }
    const std::string_view data(reinterpret_cast<const char*>(event_.data.data()), event_.data.size());
    const auto fingerprint = BinaryCursor(data, std::endian::big).number<std::int64_t>();
    if (const Result<ScanTimes> times = decode_scan_times(std::as_bytes(std::span(event_.data))); times.ok()) {
      times_[event_.channel] = times.value();
    }
    has_raw_bytes_ = has_raw_bytes_ || fingerprint == bot_core::raw_t::getHash();
    head.topic = topic_of(event_.channel, type_of(fingerprint), fingerprint == bot_core::planar_lidar_t::getHash());
    head.recorded_ns = microseconds_to_ns(event_.time_us);
    return true;
  }

  DecodedScan decode() override {
    LogScan scan;
    scan.ranges_m.resize(event_.data.size() / sizeof(float));
    const Result<RawScan> decoded = decode_scan(std::as_bytes(std::span(event_.data)), scan.ranges_m);
    if (!decoded.ok()) {
      return describe(decoded.error());
    }
    scan.stamp_ns = decoded.value().stamp_ns;
    scan.start_angle_rad = decoded.value().start_angle_rad;
    scan.angle_step_rad = decoded.value().angle_step_rad;
    if (const auto times = times_.find(times_channel(event_.channel)); times != times_.end()) {
      scan.first_beam_ns = times->second.first_beam_ns;
      scan.beam_period_ns = times->second.beam_period_ns;
    }
    scan.ranges_m.resize(decoded.value().ranges_m.size());
    return scan;
  }

 private:
  static std::int64_t microseconds_to_ns(std::int64_t time_us) {
    constexpr std::int64_t kMaxUs = std::numeric_limits<std::int64_t>::max() / 1000;
    return std::clamp(time_us, -kMaxUs, kMaxUs) * 1000;
  }

  EventLog events_;
  LoggedMessage event_;
  std::map<std::string, ScanTimes, std::less<>> times_;  ///< by the channel that told them last
  bool has_raw_bytes_ = false;
};

}  // namespace

bool is_lcm_log(std::string_view head) {
  using namespace std::string_view_literals;
  return head.starts_with("\xed\xa1\xda\x01"sv);
}

std::unique_ptr<MessageLog> open_lcm_log(std::unique_ptr<ByteStream> bytes, const std::filesystem::path& path) {
  return std::make_unique<LcmLog>(std::move(bytes), path.string());
}

}  // namespace odoless
