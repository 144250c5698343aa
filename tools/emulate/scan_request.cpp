#include "tools/emulate/scan_request.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "tools/emulate/scip_text.hpp"

namespace odoless::scip {
namespace {

constexpr std::size_t kGetCharacters = 12;
constexpr std::size_t kStreamCharacters = 15;

/// A number of the request, and the status that says that it is none.
struct Field {
  int ScanRequest::*member;
  std::size_t start;
  std::size_t digits;
  const char* status;
};

constexpr std::array<Field, 5> kFields{{{&ScanRequest::first_step, 2, 4, "01"},
                                        {&ScanRequest::last_step, 6, 4, "02"},
                                        {&ScanRequest::cluster, 10, 2, "03"},
                                        {&ScanRequest::skip, 12, 1, "06"},
                                        {&ScanRequest::count, 13, 2, "07"}}};

const char* status_of_steps(const ScanRequest& request, const ScipModel& model) {
  if (request.last_step > model.last_step) {
    return "04";
  }
  return request.last_step < request.first_step ? "05" : "00";
}

}  // namespace

bool is_scan_request(std::string_view text, const ScipModel& model) {
  if (text.size() < 2) {
    return false;
  }
  const bool is_single = text[0] == 'M' || text[0] == 'G';
  const bool has_echoes = model.has_echoes && (text[0] == 'N' || text[0] == 'H');
  return (is_single || has_echoes) && (text[1] == 'D' || text[1] == 'E' || (text[1] == 'S' && is_single));
}

std::string ScanRequest::echo(int left) const {
  return is_stream ? fmt::format("{}{:02}{}", text.substr(0, 13), left, text.substr(kStreamCharacters)) : text;
}

ScanRequest parse_scan_request(std::string_view text, const ScipModel& model) {
  ScanRequest request;
  request.text = text;
  request.is_stream = text[0] == 'M' || text[0] == 'N';
  request.has_echoes = text[0] == 'N' || text[0] == 'H';
  request.reading = text[1];
  const std::string_view numbers = text.substr(0, text.find(';'));
  if (numbers.size() != (request.is_stream ? kStreamCharacters : kGetCharacters)) {
    request.status = "0C";
    return request;
  }
  for (const Field& field : kFields) {
    if (field.start >= numbers.size()) {
      break;
    }
    const std::optional<int> value = decimal(numbers, field.start, field.digits);
    if (!value) {
      request.status = field.status;
      return request;
    }
    request.*field.member = *value;
  }
  request.cluster = std::max(request.cluster, 1);
  request.status = status_of_steps(request, model);
  return request;
}

}  // namespace odoless::scip
