#pragma once

#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/lrf/sopas/telegram.hpp"

namespace odoless::sopas {

/// How the ranges of a scan are to be read.
struct ScanShape {
  int beams = 0;
  std::int32_t start_tmdeg = 0;  ///< ten-thousandths of a degree
  int step_tmdeg = 0;
  float scale = 1.0F;   ///< mm per count
  float offset = 0.0F;  ///< mm
  /// What follows the ranges: a damaged telegram without a sum has less of it.
  int left = 0;
  /// Whether that is as documented. It is not where bytes are missing before it that cancel out in a sum by XOR, for
  /// then the telegram ends among the next one's first bytes.
  bool has_whole_tail = true;
  friend bool operator==(const ScanShape&, const ScanShape&) = default;
};

/// What a telegram LMDscandata says.
struct ScanData {
  int version = 0;
  int device_number = 0;
  std::uint32_t serial_number = 0;
  int device_status = 0;  ///< 0: in order, 1: error, 2: dirt (warning), 4: dirt (error)
  int telegram_counter = 0;
  int scan_counter = 0;
  std::uint32_t stamp_us = 0;     ///< of the scan, since the device was switched on
  std::uint32_t sending_us = 0;   ///< of its sending, on the same clock
  double scans_hz = 0.0;          ///< that it measures, whether or not it sends them all
  double measurements_khz = 0.0;  ///< single ones
  int encoders = 0;
  ScanShape shape;  ///< of the first echo, DIST1
  int channels = 0;
  bool has_second_echo = false;  ///< DIST2 is there, too
  bool has_remission = false;    ///< RSSI1 is there, of 8 or 16 bits
};

/// Reads a telegram "sSN LMDscandata" or "sRA LMDscandata". @param ranges  Takes the counts of DIST1.
///
/// Errors: Errc::kWrongCount (DIST1 is not there, or has more values than there is room for), kFrameMalformed.
/// Real time: linear in the bytes.
[[nodiscard]] Result<ScanData> scan_data_of(const Telegram& telegram, std::span<std::uint16_t> ranges);

}  // namespace odoless::sopas
