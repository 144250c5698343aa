#include "drivers/tilt/cia402/set_up.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/tilt/cia402/power_state.hpp"

namespace odoless::cia402 {
namespace {

using canopen::Object;

constexpr std::uint32_t kInvalidPdo = 1U << 31U;
constexpr std::uint32_t kNoRemoteRequest = 1U << 30U;
constexpr std::uint8_t kAtEachSync = 1;
constexpr std::uint8_t kAtOnce = 0xFF;
constexpr std::uint16_t kMappingOffset = 0x200;
constexpr std::uint16_t kFirstTransmitPdo = 0x1800;
constexpr std::uint32_t kQuickStopOnLostMaster = 3;     // 6007h
constexpr std::uint32_t kLowestPosition = 0x80000000U;  // 607Dh: no limits
constexpr std::uint32_t kHighestPosition = 0x7FFFFFFFU;
constexpr std::uint32_t kStayInQuickStop = 6;    // 605Ah: on the quick stop slope, then hold ...
constexpr std::uint32_t kStayAfterSlope = 5;     // ... or on the profile's
constexpr std::uint32_t kTransferError = 0x05U;  // first byte of an abort code that is of the transfer, not the object

constexpr std::array<std::uint32_t, 2> kCommandMapping{0x60400010, 0x607A0020};
constexpr std::array<std::uint32_t, 3> kStatusMapping{0x60410010, 0x60640020, 0x60610008};
constexpr std::array<std::uint32_t, 1> kVelocityMapping{0x606C0020};

std::uint32_t whole(double value) {
  return static_cast<std::uint32_t>(std::clamp(std::round(value), 1.0, 4294967295.0));
}

std::uint32_t milliseconds(std::int64_t duration_ns) {
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(duration_ns / 1'000'000, 1, 65535));
}

}  // namespace

SetUp::SetUp(const TiltParams& params, const TiltScale& scale) {
  const auto node = static_cast<std::uint32_t>(params.id);
  add(kControlWord, kQuickStopControl, 2, true);  // whatever it does for whoever was here before
  add({0x1005, 0}, canopen::kSyncCob, 4, true);
  add_heartbeats(params);
  add_pdo(0x1400, canopen::kReceivePdo1Cob + node, params.cyclic_position ? kAtEachSync : kAtOnce, kCommandMapping);
  add_pdo(0x1800, canopen::kTransmitPdo1Cob + node, kAtEachSync, kStatusMapping);
  add_pdo(0x1801, canopen::kTransmitPdo2Cob + node, kAtEachSync, kVelocityMapping);
  add_motion(params, scale);
  add_homing(params, scale);
  if (params.cyclic_position) {
    add_cyclic(params);
  }
  add(kModeOfOperation, run_mode(params), 1);
}

// How long a drive takes to come from one target to the next: units of 10^-3 s, so long as they are whole.
void SetUp::add_cyclic(const TiltParams& params) {
  constexpr std::uint32_t kMilliseconds = 0xFD;  // -3
  add({0x60C2, 2}, kMilliseconds, 1, true);
  add({0x60C2, 1}, std::min(milliseconds(params.sample_period_ns), 255U), 1, true);
}

void SetUp::add(Object object, std::uint32_t value, int size_bytes, bool optional) {
  ODOLESS_CHECK(count_ < settings_.size());
  settings_[count_++] = {object, value, size_bytes, optional};
}

void SetUp::add_instead(std::uint32_t value) {
  const Setting before = settings_[count_ - 1];
  add(before.object, value, before.size_bytes, true);
  settings_[count_ - 1].instead = true;
}

std::size_t SetUp::next(std::size_t at, bool was_refused) const {
  ++at;
  while (!was_refused && at < count_ && settings_[at].instead) {
    ++at;
  }
  return at;
}

// CiA 301, 7.5.2.38: a mapping can be changed only while its PDO is invalid and its count 0.
void SetUp::add_pdo(std::uint16_t communication, std::uint32_t cob, std::uint8_t kind,
                    std::span<const std::uint32_t> mapping) {
  const auto mapped = static_cast<std::uint16_t>(communication + kMappingOffset);
  const std::uint32_t valid = cob | (communication >= kFirstTransmitPdo ? kNoRemoteRequest : 0U);
  add({communication, 1}, valid | kInvalidPdo, 4);
  add({mapped, 0}, 0, 1);
  std::uint8_t sub = 0;
  for (const std::uint32_t entry : mapping) {
    add({mapped, ++sub}, entry, 4);
  }
  add({mapped, 0}, sub, 1);
  const bool is_sent = communication >= kFirstTransmitPdo;
  add({communication, 2}, kind, 1, !is_sent);  // what is received counts at once, or at the SYNC behind it
  if (is_sent) {
    add({communication, 3}, 0, 2, true);  // no inhibit time
    add({communication, 5}, 0, 2, true);  // no event timer
  }
  add({communication, 1}, valid, 4);
}

void SetUp::add_heartbeats(const TiltParams& params) {
  add(kOwnHeartbeat, milliseconds(params.heartbeat_period_ns), 2, true);
  if (params.master_id != 0) {
    const std::uint32_t timeout_ms = milliseconds(3 * params.heartbeat_period_ns);
    add(kWatchedHeartbeat, static_cast<std::uint32_t>(params.master_id) << 16U | timeout_ms, 4, true);
    add({0x6007, 0}, kQuickStopOnLostMaster, 2, true);
  }
}

void SetUp::add_motion(const TiltParams& params, const TiltScale& scale) {
  const std::int32_t one_end = scale.position_counts(params.limit_min_rad);
  const std::int32_t other_end = scale.position_counts(params.limit_max_rad);
  const bool is_ours = params.cyclic_position;  // or an axis that rests outside them would leap to the next one
  add({0x607D, 1}, is_ours ? kLowestPosition : static_cast<std::uint32_t>(std::min(one_end, other_end)), 4, true);
  add({0x607D, 2}, is_ours ? kHighestPosition : static_cast<std::uint32_t>(std::max(one_end, other_end)), 4, true);
  const std::uint32_t slope = whole(scale.counts(params.acceleration_radps2) * params.speed_units_per_count);
  add({0x6081, 0}, whole(scale.counts(params.speed_radps) * params.speed_units_per_count), 4);
  add({0x6083, 0}, slope, 4);
  add({0x6084, 0}, slope, 4, true);
  add({0x6085, 0}, slope, 4, true);
  add({0x605A, 0}, kStayInQuickStop, 2, true);
  add_instead(kStayAfterSlope);
}

void SetUp::add_homing(const TiltParams& params, const TiltScale& scale) {
  if (params.homing_method == 0) {
    return;
  }
  const std::uint32_t speed = whole(scale.counts(params.homing_speed_radps) * params.speed_units_per_count);
  add({0x6098, 0}, static_cast<std::uint32_t>(params.homing_method), 1);
  add({0x6099, 1}, speed, 4);
  add({0x6099, 2}, std::max(speed / 4, 1U), 4);
  add({0x609A, 0}, whole(scale.counts(params.acceleration_radps2) * params.speed_units_per_count), 4, true);
}

bool SetUp::tolerates(const Setting& setting, std::uint32_t abort_code) {
  return setting.optional && abort_code >> 24U != kTransferError;
}

std::optional<TiltLack> SetUp::lack_without(std::size_t at) const {
  const bool is_last_try = next(at, true) == next(at, false);
  if (!is_last_try) {
    return std::nullopt;
  }
  switch (settings_[at].object.index) {
    case 0x1016:
      return TiltLack::kWatchOfDaemon;
    case 0x1017:
      return TiltLack::kHeartbeat;
    case 0x605A:
      return TiltLack::kHoldAfterStop;
    case 0x6007:
      return TiltLack::kStopWithoutDaemon;
    case 0x607D:
      return TiltLack::kLimits;
    default:
      return std::nullopt;
  }
}

}  // namespace odoless::cia402
