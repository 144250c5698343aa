#include "firmware/lcm/lcm_link.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "core/base/check.hpp"
#include "drivers/io/file_descriptor.hpp"
#include "firmware/lcm/messages.hpp"
#include "firmware/lcm/udp_address.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kVelocityAgeMaxNs = 1'000'000'000;
constexpr std::size_t kHeaderMaxBytes = 200;  // all that stands before the data of a tile or a map

constexpr std::string_view kUdp = "udpm://";

// Why nothing can be sent to the group; 0: it can. liblcm would find out the same, and write fifteen lines about it to
// standard error at each attempt.
int route_error(const std::string& url) {
  const Result<MulticastAddress> wanted = parse_udp_address(url.substr(0, url.find('?')));
  const MulticastAddress to =
      wanted.ok() ? wanted.value() : MulticastAddress{.group = 0xEFFF4C43, .port = 7667};  // liblcm's own
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(to.port);
  group.sin_addr.s_addr = htonl(to.group);
  const FileDescriptor probe(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&group), sizeof(group)) == 0 ? 0 : errno;
}

// The first of several that is not kOk.
Errc first_error(Errc a, Errc b) { return a != Errc::kOk ? a : b; }

std::string with_ttl(const std::string& url, int ttl) {
  if (url.find(kUdp) == std::string::npos) {
    return url;  // only datagrams have one
  }
  return url + (url.find('?') == std::string::npos ? '?' : '&') + "ttl=" + std::to_string(ttl);
}

}  // namespace

/// One message of every kind, kept for the memory of their vectors.
struct LcmLink::Messages {
  Messages() {
    scan.ranges.reserve(kMessageMaxBytes / sizeof(float));
    raw.data.reserve(kMessageMaxBytes);
    tile.data.resize(kMessageMaxBytes - kHeaderMaxBytes);
    map.mapData.resize(kMessageMaxBytes - kHeaderMaxBytes);
    motion.alternatives.reserve(Motion::kAlternativesMax);
    points.points.assign(kPointsMax, std::vector<float>(3));
    points.seq = -1;
    reserve_cloud(cloud);
  }

  bot_core::planar_lidar_t scan{};
  scan_times_t scan_times{};
  bot_core::raw_t raw{};
  bot_core::joint_state_t tilt{};
  motion_t motion{};
  pose_estimate_t pose_estimate{};
  bot_core::pose_t pose{};
  bot_core::rigid_transform_t map_to_odom{};
  correction_t correction{};
  map_tile_t tile{};
  occ_map::pixel_map_t map{};
  health_t health{};
  cloud_health_t cloud_health{};
  world_t world{};
  bot_core::sensor_status_t lrf_status{};
  bot_core::pointcloud_t points{};
  bot_core::pointcloud_t cloud{};
};

LcmLink::LcmLink(const LcmParams& params, std::size_t map_cells_max)
    : params_(params),
      channels_(params.prefix),
      messages_(std::make_unique<Messages>()),
      buffer_(kMessageMaxBytes),
      signed_(params.key_file.empty() ? 0 : kMessageMaxBytes + kTrailerBytes),
      // Halving rounds up: a single row of cells only becomes half of them.
      halved_cells_(map_cells_max / 2 + 1),
      last_scan_message_{.again_channel = channels_.scan_again},
      last_motion_message_{.again_channel = channels_.motion_again} {}

LcmLink::~LcmLink() = default;

Errc LcmLink::fail(Errc error, std::string reason) {
  reason_ = std::move(reason);
  return error;
}

Errc LcmLink::open() {
  if (params_.prefix.size() > kChannelPrefixMaxBytes) {
    return fail(Errc::kBadAddress, "the prefix of the channels, '" + params_.prefix + "', is longer than " +
                                       std::to_string(kChannelPrefixMaxBytes) + " bytes");
  }
  if (params_.url.find("ttl=") != std::string::npos) {
    return fail(Errc::kBadAddress, "the address '" + params_.url + "' has a ttl: set the parameter ttl instead");
  }
  if (params_.url.empty()) {
    return Errc::kOk;
  }
  if (!params_.key_file.empty() && !signer_) {
    std::string reason;
    const Result<LcmKey> key = read_key(params_.key_file, reason);
    if (!key.ok()) {
      return fail(key.error(), std::move(reason));
    }
    signer_.emplace(key.value());
  }
  const std::string url = with_ttl(params_.url, params_.ttl);
  if (const int error = url.starts_with(kUdp) ? route_error(url) : 0; error != 0) {
    return fail(Errc::kUnavailable, "LCM cannot use '" + url + "': " + std::generic_category().message(error) +
                                        ": the host needs a route for multicast (`ip link set lo up` and `ip route add "
                                        "224.0.0.0/4 dev lo`, or a network); it is tried again every 2 s");
  }
  lcm_.reset(lcm_create(url.c_str()));
  if (lcm_ == nullptr) {
    return fail(Errc::kUnavailable,
                "LCM cannot use '" + url + "': an address of the form udpm://239.255.76.67:7667 is needed (lcm.url)");
  }
  return Errc::kOk;
}

void LcmLink::send_again() {
  sends_again_ = true;
  last_scan_message_.message.reserve(kMessageMaxBytes);
  last_motion_message_.message.reserve(kMessageMaxBytes);
}

Errc LcmLink::refuse_too_long() {
  ++counters_.too_long;
  return Errc::kTooLong;
}

template <class Message>
Errc LcmLink::send(const std::string& channel, const Message& message, bool to_tap_alone) {
  const int size_bytes = message.getEncodedSize();
  if (std::cmp_greater(size_bytes, buffer_.size())) {
    return refuse_too_long();
  }
  const int written_bytes = message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
  ODOLESS_CHECK(written_bytes == size_bytes);
  const std::span<const std::byte> bytes(buffer_.data(), static_cast<std::size_t>(size_bytes));
  if (tap_ != nullptr) {
    // As lcm-logger stamps what it hears; a replay's own stamps may be of another clock than those of its health.
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    tap_->record(channel, bytes, std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
  }
  return to_tap_alone ? Errc::kOk : transmit(channel, bytes);
}

void LcmLink::send_again(Last& last, int times) {
  for (; times > 0 && last.times_left > 0; --times, --last.times_left) {
    static_cast<void>(transmit(last.again_channel, last.message));  // counted
  }
}

template <class Message>
Errc LcmLink::send_and_keep(const std::string& channel, const Message& message, Last& last) {
  if (!sends_again_) {
    return send(channel, message);
  }
  send_again(last_scan_message_, params_.send_again);
  send_again(last_motion_message_, params_.send_again);
  send_again(last, last.times_left);
  const Errc error = send(channel, message);
  const auto size_bytes = error == Errc::kTooLong ? 0 : message.getEncodedSize();
  last.message.assign(buffer_.begin(), buffer_.begin() + size_bytes);
  last.times_left = size_bytes == 0 ? 0 : 2 * params_.send_again;
  return error;
}

// Those that a daemon takes from another.
std::span<const std::byte> LcmLink::signed_message(const std::string& channel, std::span<const std::byte> message) {
  if (!signer_ || !channels_.is_taken(channel)) {
    return message;
  }
  const auto trailer = signer_->sign(channel, message, wall_clock_us());
  const auto end = std::copy(message.begin(), message.end(), signed_.begin());
  std::copy(trailer.begin(), trailer.end(), end);
  return std::span(signed_).first(message.size() + trailer.size());
}

Errc LcmLink::transmit(const std::string& channel, std::span<const std::byte> message) {
  if (params_.url.empty()) {
    return Errc::kOk;
  }
  const std::span<const std::byte> sent = signed_message(channel, message);
  if (lcm_ == nullptr ||
      lcm_publish(lcm_.get(), channel.c_str(), sent.data(), static_cast<unsigned int>(sent.size())) != 0) {
    ++counters_.errors;
    return Errc::kUnavailable;
  }
  ++counters_.messages;
  counters_.bytes += static_cast<std::int64_t>(sent.size());
  return Errc::kOk;
}

Errc LcmLink::publish(const ScanRecord& scan, std::span<const float> ranges_m) {
  if (ranges_m.size_bytes() > kMessageMaxBytes) {
    return refuse_too_long();
  }
  if (scan.beam_period_ns != 0) {
    to_message(scan, messages_->scan_times);
    static_cast<void>(send(channels_.scan_times, messages_->scan_times));  // counted
  }
  to_message(scan, ranges_m, messages_->scan);
  return send_and_keep(channels_.scan, messages_->scan, last_scan_message_);
}

Errc LcmLink::publish(const RawBytesRecord& raw, std::span<const std::byte> bytes) {
  if (bytes.size() > kMessageMaxBytes) {
    return refuse_too_long();
  }
  to_message(raw, bytes, messages_->raw);
  return send(raw_channel(raw.line, raw.to_device != 0), messages_->raw, !params_.raw_bytes);
}

const std::string& LcmLink::raw_channel(RawLine line, bool to_device) const {
  switch (line) {
    case RawLine::kLaser:
      break;
    case RawLine::kTilt:
      return to_device ? channels_.tilt_raw_tx : channels_.tilt_raw_rx;
    case RawLine::kGpio:
      return to_device ? channels_.gpio_raw_tx : channels_.gpio_raw_rx;
  }
  return to_device ? channels_.lrf_raw_tx : channels_.lrf_raw_rx;
}

Errc LcmLink::publish(const TiltRecord& tilt) {
  to_message(tilt, messages_->tilt);
  return send(channels_.tilt, messages_->tilt);
}

Errc LcmLink::publish(const Motion& motion) {
  last_motion_ = motion;
  to_message(motion, messages_->motion);
  return send_and_keep(channels_.motion, messages_->motion, last_motion_message_);
}

Errc LcmLink::publish(const PoseRecord& pose) {
  const bool fresh = std::abs(pose.stamp_ns - last_motion_.to_stamp_ns) <= kVelocityAgeMaxNs;
  const Velocity velocity = fresh ? velocity_of(last_motion_, pose.map_T_scan.yaw_rad) : Velocity{};
  to_message(pose, velocity, messages_->pose);
  Errc error = send(channels_.pose, messages_->pose);
  to_laser_message(pose, velocity, messages_->pose);
  error = first_error(error, send(channels_.laser_pose, messages_->pose));
  to_message(pose, messages_->pose_estimate);
  error = first_error(error, send(channels_.pose_covariance, messages_->pose_estimate));
  to_message(pose, messages_->map_to_odom);
  return first_error(error, send(channels_.map_to_odom, messages_->map_to_odom));
}

Errc LcmLink::publish(const MapCorrection& correction) {
  to_message(correction, messages_->correction);
  return send(channels_.correction, messages_->correction);
}

Errc LcmLink::publish(const MapTileRecord& tile, std::span<const std::uint8_t> cells) {
  const Result<std::size_t> size_bytes = deflater_.deflate(cells, messages_->tile.data);
  if (!size_bytes.ok()) {
    return refuse_too_long();
  }
  to_message(tile, tiles_sent_++, messages_->tile);
  messages_->tile.datasize = static_cast<std::int32_t>(size_bytes.value());
  return send(channels_.map_tile, messages_->tile);
}

Errc LcmLink::publish(const HealthReport& health) {
  to_message(health, messages_->health);
  Errc error = send(channels_.health, messages_->health);
  if (health.cloud) {
    to_message(*health.cloud, health.stamp_ns, messages_->cloud_health);
    error = first_error(error, send(channels_.cloud_health, messages_->cloud_health));
  }
  if (health.world) {
    to_message(*health.world, health, messages_->world);
    error = first_error(error, send(channels_.world, messages_->world));
  }
  to_message(health, laser_, messages_->lrf_status);
  return first_error(error, send(channels_.lrf_status, messages_->lrf_status));
}

Errc LcmLink::publish(const MapView& map) {
  occ_map::pixel_map_t& message = messages_->map;
  MapView shown = map;
  Result<std::size_t> size_bytes = deflater_.deflate(shown.cells, message.mapData);
  while (!size_bytes.ok()) {
    if (halved_cells(shown.columns, shown.rows) > halved_cells_.size()) {
      return refuse_too_long();
    }
    shown = halved(shown, halved_cells_);
    size_bytes = deflater_.deflate(shown.cells, message.mapData);
  }
  message.utime = shown.stamp_ns / 1000;
  message.dimensions[0] = shown.columns;
  message.dimensions[1] = shown.rows;
  message.xy0[0] = shown.lower_left_x_m;
  message.xy0[1] = shown.lower_left_y_m;
  message.xy1[0] = shown.lower_left_x_m + shown.columns * shown.cell_size_m;
  message.xy1[1] = shown.lower_left_y_m + shown.rows * shown.cell_size_m;
  message.mpp = shown.cell_size_m;
  message.compressed = 1;
  message.data_type = occ_map::pixel_map_t::TYPE_UINT8;
  message.datasize = static_cast<std::int32_t>(size_bytes.value());
  return send(channels_.map, message);
}

Errc LcmLink::publish_points(const PoseRecord& pose, const ScanRecord& scan, std::span<const float> ranges_m) {
  if (!params_.scan_points) {
    return Errc::kOk;
  }
  to_points(pose, scan, ranges_m, messages_->points);
  return send(channels_.scan_points, messages_->points);
}

Errc LcmLink::publish(const CloudPiece& piece) {
  to_message(piece, messages_->cloud);
  return send(channels_.cloud, messages_->cloud);
}

}  // namespace odoless
