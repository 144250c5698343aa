#include "tools/emulate/faults.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr std::array<std::string_view, 12> kNames{"silence",  "garbage", "truncate", "wrong-sum", "reboot", "drift",
                                                  "one-byte", "stuck",   "beams",    "stall",     "error",  "stop"};
constexpr double kSecondsMax = 1e8;
constexpr double kRebootS = 0.3;

UsageError bad_fault(const std::string& text, std::string_view wrong) {
  return UsageError(
      fmt::format("--fault {}: {}; expected KIND[=VALUE]@SECONDS[:DURATION], such as silence@10:2 or "
                  "drift=1000@0, KIND one of {}",
                  text, wrong, fault_names()));
}

std::optional<double> number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool ok = error == std::errc{} && end == text.data() + text.size() && std::abs(value) <= kSecondsMax;
  return ok ? std::optional(value) : std::nullopt;
}

/// What is before `mark`; the rest stays in `text`, empty where there is no mark.
std::string_view cut(std::string_view& text, char mark) {
  const std::size_t at = std::min(text.find(mark), text.size());
  const std::string_view before = text.substr(0, at);
  text.remove_prefix(std::min(at + 1, text.size()));
  return before;
}

}  // namespace

std::string fault_names() {
  std::string names;
  for (const std::string_view name : kNames) {
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  return names;
}

Fault parse_fault(const std::string& text) {
  std::string_view duration = text;
  std::string_view start = cut(duration, ':');
  std::string_view value = cut(start, '@');
  const std::string_view name = cut(value, '=');
  const auto* const found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) {
    throw bad_fault(text, "no such kind");
  }
  const auto kind = static_cast<FaultKind>(found - kNames.begin());
  const std::optional<double> start_s = number(start);
  const std::optional<double> lasts_s = duration.empty() && kind == FaultKind::kReboot ? kRebootS : number(duration);
  if (!start_s || *start_s < 0.0 || (!duration.empty() && (!lasts_s || *lasts_s <= 0.0))) {
    throw bad_fault(text, "not a time in seconds");
  }
  if (number(value).has_value() != (kind == FaultKind::kDrift || kind == FaultKind::kError)) {
    throw bad_fault(text, "drift has a value in parts per million, error its number, and no other has one");
  }
  const auto start_ns = std::llround(*start_s * 1e9);
  return {.kind = kind,
          .value = number(value).value_or(0.0),
          .start_ns = start_ns,
          .end_ns = lasts_s ? start_ns + std::llround(*lasts_s * 1e9) : std::numeric_limits<std::int64_t>::max()};
}

const Fault* active_fault(const std::vector<Fault>& faults, FaultKind kind, std::int64_t time_ns) {
  const auto found = std::find_if(faults.begin(), faults.end(),
                                  [&](const Fault& fault) { return fault.kind == kind && fault.active(time_ns); });
  return found == faults.end() ? nullptr : &*found;
}

}  // namespace odoless
