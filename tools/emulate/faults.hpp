#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace odoless {

enum class FaultKind : std::uint8_t {
  kSilence,   ///< neither hears nor answers
  kGarbage,   ///< random bytes instead of scans
  kTruncate,  ///< each scan ends in its middle
  kWrongSum,  ///< one character of each scan is another
  kReboot,    ///< starts anew, its counter too; silent for the duration (0.3 s)
  kDrift,     ///< its counter runs faster by VALUE parts in a million
  kOneByte,   ///< writes byte by byte
  kStuck,     ///< sends the same ranges again and again
  kBeams,     ///< scans have a third of their beams less
  kStall,     ///< servo: doesn't move
  kError,     ///< servo: reports the error VALUE, and is off until it is reset
  kStop,      ///< GPIO: the emergency stop is pressed
};

/// One fault of an emulated device; times since a laser's stream was started first, or a servo was first spoken to.
struct Fault {
  FaultKind kind = FaultKind::kSilence;
  double value = 0.0;
  std::int64_t start_ns = 0;
  std::int64_t end_ns = 0;

  [[nodiscard]] bool active(std::int64_t time_ns) const { return time_ns >= start_ns && time_ns < end_ns; }
};

/// Reads KIND[=VALUE]@SECONDS[:DURATION]; without a duration it is for ever.
/// @throws UsageError that says what is wrong and what would be right.
[[nodiscard]] Fault parse_fault(const std::string& text);

/// The fault of that kind that is active, or null.
[[nodiscard]] const Fault* active_fault(const std::vector<Fault>& faults, FaultKind kind, std::int64_t time_ns);

/// The names, for help texts.
[[nodiscard]] std::string fault_names();

}  // namespace odoless
