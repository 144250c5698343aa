#include "drivers/lrf/scip/time_query.hpp"

#include <algorithm>

#include "drivers/lrf/scip/number.hpp"

namespace odoless::scip {
namespace {

constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr std::int64_t kNsPerBaudAndByte = 10'000'000'000;  ///< with start and stop bit
constexpr std::int64_t kRequestBytes = 4;
constexpr std::int64_t kReplyBytes = 14;
constexpr std::int64_t kUnsureMaxNs = 20 * kNsPerMs;

/// The time in an answer to TM1: four characters and their sum.
std::optional<std::uint32_t> time_ms(const Reply& reply) {
  const std::string_view line = reply.line(2);
  const Result<Status> answer = status_of(reply);
  const bool is_time = answer.ok() && answer.value() == status("00") && line.size() == 5 && sum_matches(line);
  return is_time && is_encoded(line.substr(0, 4)) ? std::optional(decode(line.substr(0, 4))) : std::nullopt;
}

}  // namespace

void TimeQuery::start(int line_baud) {
  stage_ = kEnter;
  request_way_ns_ = line_baud == 0 ? 0 : kRequestBytes * kNsPerBaudAndByte / line_baud;
  reply_way_ns_ = line_baud == 0 ? 0 : kReplyBytes * kNsPerBaudAndByte / line_baud;
  first_ms_.reset();
}

std::string_view TimeQuery::name() const { return stage_ == kEnter ? "TM0\n" : stage_ < kLeave ? "TM1\n" : "TM2\n"; }

std::string_view TimeQuery::request(std::int64_t now_ns) {
  asked_ns_ = now_ns;
  return name();
}

bool TimeQuery::on_reply(const Reply& reply, std::int64_t now_ns) {
  if (reply.line(0) != name().substr(0, 3)) {
    return false;
  }
  const bool is_slow = now_ns - asked_ns_ - request_way_ns_ - reply_way_ns_ > kUnsureMaxNs;
  if (stage_ == kEnter) {
    const Result<Status> answer = status_of(reply);
    const bool is_in = answer.ok() && (answer.value() == status("00") || answer.value() == status("02"));
    stage_ = !is_in ? kLeave + 1 : is_slow ? kLeave : kEnter + 1;
  } else if (stage_ == kLeave) {
    ++stage_;
  } else if (const std::optional<std::uint32_t> device_ms = time_ms(reply)) {
    learn(*device_ms, now_ns);
    ++stage_;
  } else {
    stage_ = kLeave;
  }
  return true;
}

// The clock shows whole milliseconds: it may have been almost one later than it said.
void TimeQuery::learn(std::uint32_t device_ms, std::int64_t now_ns) {
  const bool is_first = !first_ms_;
  const std::int64_t since_ns =
      static_cast<std::int64_t>((device_ms - first_ms_.value_or(device_ms)) & 0xFFFFFFU) * kNsPerMs;
  const std::int64_t earliest_ns = asked_ns_ + request_way_ns_ - since_ns - kNsPerMs;
  const std::int64_t latest_ns = now_ns - reply_way_ns_ - since_ns;
  first_ms_ = first_ms_.value_or(device_ms);
  earliest_ns_ = is_first ? earliest_ns : std::max(earliest_ns_, earliest_ns);
  latest_ns_ = is_first ? latest_ns : std::min(latest_ns_, latest_ns);
}

std::optional<ClockReading> TimeQuery::reading() const {
  const bool is_one = first_ms_ && earliest_ns_ <= latest_ns_ && latest_ns_ - earliest_ns_ <= kUnsureMaxNs;
  return is_one ? std::optional(ClockReading{*first_ms_, earliest_ns_ + (latest_ns_ - earliest_ns_) / 2})
                : std::nullopt;
}

}  // namespace odoless::scip
