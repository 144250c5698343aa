#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace odoless {

/// Bytes that went over a device's line at once; of a CAN bus one frame (CanFrame).
struct RawPiece {
  std::int64_t time_us = 0;
  bool to_device = false;
  std::string bytes;
};

/// What the daemon's recorder kept of its devices' lines, each in its order.
struct RawRecording {
  std::vector<RawPiece> laser;
  std::vector<RawPiece> servo;
  std::vector<RawPiece> gpio;  ///< a GpioChange each
  bool servo_is_on_can = false;
};

/// Reads bot_core.raw_t of an LCM log, from the channels that end in LRF_RAW_, TILT_RAW_ and GPIO_RAW_RX and _TX. Of a
/// CAN bus, what answers nothing and is answered by nothing is left out (echoes of SYNC, error frames, the daemon's
/// heartbeat and process data), and each answer stands behind its own question: SDO after SDO, process data after SYNC.
///
/// @throws NoInputError; DataError: not an LCM log, a message that is none, or no bytes of a device at all.
[[nodiscard]] RawRecording read_raw_recording(const std::filesystem::path& path);

}  // namespace odoless
