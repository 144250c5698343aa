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
  bool servo_is_on_can = false;
};

/// Reads bot_core.raw_t of an LCM log, from the channels that end in LRF_RAW_RX and _TX, TILT_RAW_RX and _TX. A CAN
/// bus gives its SYNC back to whoever sent it; those echoes are left out.
///
/// @throws NoInputError; DataError: not an LCM log, a message that is none, or no bytes of a device at all.
[[nodiscard]] RawRecording read_raw_recording(const std::filesystem::path& path);

}  // namespace odoless
