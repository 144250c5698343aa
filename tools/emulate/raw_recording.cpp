#include "tools/emulate/raw_recording.hpp"

#include <fmt/format.h>
#include <lcm/eventlog.h>

#include <bot_core/raw_t.hpp>
#include <memory>
#include <optional>
#include <string_view>

#include "drivers/tilt/cia402/canopen.hpp"
#include "tools/command/error.hpp"
#include "tools/log/candump.hpp"

namespace odoless {
namespace {

struct LogDeleter {
  void operator()(lcm_eventlog_t* log) const { lcm_eventlog_destroy(log); }
};
struct EventDeleter {
  void operator()(lcm_eventlog_event_t* event) const { lcm_eventlog_free_event(event); }
};

RawPiece decoded(const lcm_eventlog_event_t& event, bool to_device, const std::filesystem::path& path) {
  bot_core::raw_t raw{};
  if (raw.decode(event.data, 0, event.datalen) < 0) {
    throw DataError(path.string(), 0, fmt::format("event {} is damaged", event.eventnum), "bot_core.raw_t");
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

void add_servo(RawRecording& recording, RawPiece piece) {
  if (const std::optional<CanFrame> frame = frame_of(piece)) {
    recording.servo_is_on_can = true;
    if (!piece.to_device && (frame->is_error() || frame->id == canopen::kSyncCob)) {
      return;
    }
    const auto bytes = as_bytes(*frame);
    piece.bytes.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  recording.servo.push_back(std::move(piece));
}

void add(RawRecording& recording, const lcm_eventlog_event_t& event, const std::filesystem::path& path) {
  const std::string_view channel(event.channel, static_cast<std::size_t>(event.channellen));
  const bool to_device = channel.ends_with("_RAW_TX");
  if (channel.ends_with("LRF_RAW_RX") || channel.ends_with("LRF_RAW_TX")) {
    recording.laser.push_back(decoded(event, to_device, path));
  } else if (channel.ends_with("TILT_RAW_RX") || channel.ends_with("TILT_RAW_TX")) {
    add_servo(recording, decoded(event, to_device, path));
  }
}

}  // namespace

RawRecording read_raw_recording(const std::filesystem::path& path) {
  const std::unique_ptr<lcm_eventlog_t, LogDeleter> log(lcm_eventlog_create(path.c_str(), "r"));
  if (!log) {
    throw NoInputError(path.string() + ": cannot be opened");
  }
  RawRecording recording;
  while (const std::unique_ptr<lcm_eventlog_event_t, EventDeleter> event{lcm_eventlog_read_next_event(log.get())}) {
    add(recording, *event, path);
  }
  if (recording.laser.empty() && recording.servo.empty()) {
    throw DataError(
        path.string(), 0, "no bytes of a laser or a servo",
        "an LCM log of odolessd's recorder (recorder.path), whose channels LRF_RAW_RX and others have them");
  }
  return recording;
}

}  // namespace odoless
