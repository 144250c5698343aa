#include "tools/emulate/sick_output.hpp"

namespace odoless {
namespace {

constexpr int kMeanReply = 0xB6;
constexpr int kPartReply = 0xB7;
constexpr int kMeanPartReply = 0xBF;
constexpr int kScansMin = 2;
constexpr int kScansMax = 250;

int byte_at(std::string_view text, std::size_t at) { return static_cast<unsigned char>(text[at]); }
int number_at(std::string_view text, std::size_t at) { return byte_at(text, at) + 256 * byte_at(text, at + 1); }

/// @param parameters  Number of scans where it is a mean, first and last value where it is a part.
std::optional<SickOutput> output_of(int answer, std::string_view parameters, const sick::Variant& variant) {
  const bool is_mean = answer == kMeanReply || answer == kMeanPartReply;
  const bool is_part = answer == kPartReply || answer == kMeanPartReply;
  const std::size_t part_at = is_mean ? 1 : 0;
  if (parameters.size() < part_at + (is_part ? 4U : 0U)) {
    return std::nullopt;
  }
  SickOutput output{.answer = answer, .last = variant.beams()};
  if (is_mean) {
    output.scans = byte_at(parameters, 0);
  }
  if (is_part) {
    output.first = number_at(parameters, part_at);
    output.last = number_at(parameters, part_at + 2);
  }
  const bool is_right = (!is_mean || (output.scans >= kScansMin && output.scans <= kScansMax)) && output.first >= 1 &&
                        output.first <= output.last && output.last <= variant.beams();
  return is_right ? std::optional(output) : std::nullopt;
}

}  // namespace

bool SickOutput::is_part() const { return answer == kPartReply || answer == kMeanPartReply; }

std::size_t SickOutput::telegram_bytes() const {
  const std::size_t mean_bytes = is_mean() ? 1 : 0;
  const std::size_t part_bytes = is_part() ? 4 : 0;
  constexpr std::size_t kCommandCountStatus = 4;
  return sick::kHeadBytes + kCommandCountStatus + mean_bytes + part_bytes + 2 * static_cast<std::size_t>(values()) +
         sick::kSumBytes;
}

std::optional<SickOutput> sick_streamed(int mode, std::string_view parameters, const sick::Variant& variant) {
  switch (mode) {
    case 0x24:
      return output_of(sick::kScanReply, {}, variant);
    case 0x26:
      return output_of(kMeanReply, parameters, variant);
    case 0x27:
      return output_of(kPartReply, parameters, variant);
    case 0x28:
      return output_of(kMeanPartReply, parameters, variant);
    case 0x2A: {
      std::optional<SickOutput> output = output_of(sick::kScanReply, {}, variant);
      output->by_turns = true;
      output->last = (variant.beams() - 1) / variant.turns() + 1;  // of the first turn, which has the most
      return output;
    }
    default:
      return std::nullopt;
  }
}

std::optional<SickOutput> sick_requested(int command, std::string_view parameters, const sick::Variant& variant) {
  switch (command) {
    case 0x30:
      return parameters == "\x01" ? output_of(sick::kScanReply, {}, variant) : std::nullopt;
    case 0x36:
      return output_of(kMeanReply, parameters, variant);
    case 0x37:
      return output_of(kPartReply, parameters, variant);
    case 0x3F:
      return output_of(kMeanPartReply, parameters, variant);
    default:
      return std::nullopt;
  }
}

}  // namespace odoless
