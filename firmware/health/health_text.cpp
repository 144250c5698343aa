#include "firmware/health/health_text.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>

namespace odoless {
namespace {

constexpr std::array<const char*, 23> kReasonTexts{"no scans",
                                                   "the laser cannot be opened",
                                                   "scans are refused",
                                                   "the laser sees nothing",
                                                   "the same scan again and again",
                                                   "scans do not fit to each other",
                                                   "the scene leaves one direction open",
                                                   "scans do not fit to the map",
                                                   "scans or records are dropped, or updates cut short",
                                                   "a deadline was missed",
                                                   "not in real time",
                                                   "a file cannot be written",
                                                   "the map is full",
                                                   "LCM messages cannot be sent (is the network up?)",
                                                   "a stage does not answer",
                                                   "datagrams were lost",
                                                   "mapping is paused",
                                                   "emergency stop",
                                                   "a GPIO line or the sync pulse is missing",
                                                   "the tilt servo does not obey",
                                                   "the laser is not level",
                                                   "the 3D map is full",
                                                   "answers of the tilt servo are missing or wrong"};

}  // namespace

const char* name_of(HealthState state) {
  switch (state) {
    case HealthState::kInit:
      return "INIT";
    case HealthState::kOk:
      return "OK";
    case HealthState::kDegraded:
      return "DEGRADED";
    case HealthState::kLost:
      return "LOST";
    case HealthState::kFault:
      return "FAULT";
  }
  return "?";
}

std::string reasons_text(std::uint32_t reasons) {
  std::string text;
  for (std::size_t bit = 0; bit < kReasonTexts.size(); ++bit) {
    if ((reasons >> bit & 1U) != 0) {
      text += (text.empty() ? "" : ", ") + std::string(kReasonTexts.at(bit));
    }
  }
  return text;
}

std::string state_sentence(const HealthReport& report) {
  const std::string reasons = reasons_text(report.reasons);
  return reasons.empty() ? std::string(name_of(report.state)) : fmt::format("{}: {}", name_of(report.state), reasons);
}

}  // namespace odoless
