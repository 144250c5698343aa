#include "tools/emulate/raw_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bot_core/raw_t.hpp>
#include <optional>
#include <string_view>

#include "drivers/tilt/cia402/canopen.hpp"
#include "tools/command/error.hpp"
#include "tools/log/candump.hpp"
#include "tools/log/event_log.hpp"

namespace odoless {
namespace {

constexpr std::size_t kKeptBytesMax = std::size_t{1} << 30;

RawPiece decoded(const LoggedMessage& message, bool to_device, const std::filesystem::path& path) {
  bot_core::raw_t raw{};
  if (raw.decode(message.data.data(), 0, static_cast<int>(message.data.size())) < 0) {
    throw DataError(path.string(), 0, fmt::format("message {} is damaged", message.number), "bot_core.raw_t");
  }
  return {raw.utime, to_device, {raw.data.begin(), raw.data.end()}};
}

/// The frame of a line of candump; nothing where it isn't one.
std::optional<CanFrame> frame_of(const RawPiece& piece) {
  std::string_view line = piece.bytes;
  line.remove_suffix(line.ends_with('\n') ? 1 : 0);
  const auto recorded = parse_candump_line(line);
  return recorded ? std::optional(recorded->frame) : std::nullopt;
}

std::uint32_t base_of(std::uint32_t id) { return id & 0x780U; }

/// What of a bus is a question or an answer.
bool is_dialogue(const CanFrame& frame, bool to_device) {
  const std::uint32_t base = base_of(frame.id);
  if (frame.is_error()) {
    return false;
  }
  return to_device ? base != canopen::kHeartbeatCob && base != canopen::kReceivePdo1Cob : frame.id != canopen::kSyncCob;
}

/// Where an answer belongs: behind the last question of its kind, and what answered that so far.
std::vector<RawPiece>::iterator place_of(std::vector<RawPiece>& pieces, const CanFrame& answer) {
  const std::uint32_t base = base_of(answer.id);
  const std::uint32_t question = base == canopen::kSdoReplyCob ? canopen::kSdoRequestCob : canopen::kSyncCob;
  if (base != canopen::kSdoReplyCob && base != canopen::kTransmitPdo1Cob && base != canopen::kTransmitPdo2Cob) {
    return pieces.end();
  }
  const auto found = std::find_if(pieces.rbegin(), pieces.rend(), [&](const RawPiece& piece) {
    const auto frame = to_can_frame(std::as_bytes(std::span(piece.bytes)));
    return piece.to_device && frame && base_of(frame->id) == question;
  });
  return found == pieces.rend()
             ? pieces.end()
             : std::find_if(found.base(), pieces.end(), [](const RawPiece& piece) { return piece.to_device; });
}

void add_servo(RawRecording& recording, RawPiece piece) {
  if (const std::optional<CanFrame> frame = frame_of(piece)) {
    recording.servo_is_on_can = true;
    if (!is_dialogue(*frame, piece.to_device)) {
      return;
    }
    const auto bytes = as_bytes(*frame);
    piece.bytes.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!piece.to_device) {
      recording.servo.insert(place_of(recording.servo, *frame), std::move(piece));
      return;
    }
  }
  recording.servo.push_back(std::move(piece));
}

void add(RawRecording& recording, const LoggedMessage& message, const std::filesystem::path& path) {
  const std::string_view channel(message.channel);
  const bool to_device = channel.ends_with("_RAW_TX");
  if (channel.ends_with("LRF_RAW_RX") || channel.ends_with("LRF_RAW_TX")) {
    recording.laser.push_back(decoded(message, to_device, path));
  } else if (channel.ends_with("TILT_RAW_RX") || channel.ends_with("TILT_RAW_TX")) {
    add_servo(recording, decoded(message, to_device, path));
  } else if (channel.ends_with("GPIO_RAW_RX") || channel.ends_with("GPIO_RAW_TX")) {
    recording.gpio.push_back(decoded(message, to_device, path));
  }
}

}  // namespace

RawRecording read_raw_recording(const std::filesystem::path& path) {
  EventLog log{open_bytes(path), path.string()};
  RawRecording recording;
  std::size_t kept_bytes = 0;
  for (LoggedMessage message; log.next(message);) {
    kept_bytes += message.channel.find("_RAW_") != std::string::npos ? message.data.size() + sizeof(RawPiece) : 0;
    if (kept_bytes > kKeptBytesMax) {
      throw DataError(path.string(), 0, "there are more than 1024 MiB of devices' bytes", "a part of this log");
    }
    add(recording, message, path);
  }
  if (recording.laser.empty() && recording.servo.empty() && recording.gpio.empty()) {
    throw DataError(
        path.string(), 0, "no bytes of a laser or a servo, and no changes of GPIO lines",
        "an LCM log of odolessd's recorder (recorder.path), whose channels LRF_RAW_RX and others have them");
  }
  return recording;
}

}  // namespace odoless
