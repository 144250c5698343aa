#include "drivers/lrf/scip/bring_up.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace odoless::scip {
namespace {

/// That a device answers on its way: SCIP 1.1, time mode, another rate, no time and its mode, and one to spare.
constexpr int kProbesMax = 7;
constexpr std::array<int, 6> kRatesBaud{19200, 57600, 115200, 250000, 500000, 750000};

bool is_ok(const Reply& reply) {
  const Result<Status> answer = status_of(reply);
  return answer.ok() && answer.value() == status("00");
}

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : BringUpSteps(params, stream), rate_(params.baud, params.baud == 0 ? std::span<const int>{} : kRatesBaud) {}

void BringUp::start(std::int64_t now_ns, bool with_reset) {
  begin();
  tells_no_time_ = false;
  enter(with_reset ? Step::kReset : Step::kDrain, now_ns);
}

std::string_view BringUp::request_of(Step step, std::int64_t now_ns) {
  switch (step) {
    case Step::kReset:
      return "RS\n";
    case Step::kDrain:
      return "\nQT\n";  // the line end first: somebody may have left half a command
    case Step::kProbe:
      return "QT\n";
    case Step::kLeaveTimeMode:
      return "TM2\n";
    case Step::kSwitch:
      return "SCIP2.0\n";
    case Step::kAsk:
      return "PP\n";
    case Step::kStart:
      return stream().request();
    case Step::kTime:
      return time_.request(now_ns);
    case Step::kSetRate:
      return write_rate_request();
    case Step::kPause:
    case Step::kDone:
      break;
  }
  return {};
}

std::string_view BringUp::write_rate_request() {
  int rest = params().baud;
  for (std::size_t i = 7; i >= 2; --i, rest /= 10) {
    rate_request_[i] = static_cast<char>('0' + rest % 10);
  }
  return {rate_request_.data(), rate_request_.size()};
}

void BringUp::enter(Step step, std::int64_t now_ns) {
  if (step == Step::kDrain) {
    drain(step, now_ns);
  } else {
    wait(step, now_ns + params().reply_timeout_ns);
  }
  const std::string_view request = request_of(step, now_ns);
  send(std::as_bytes(std::span(request.data(), request.size())));
}

void BringUp::on_ignored_bytes(std::int64_t now_ns) {
  if (step() == Step::kDrain) {
    drain_on(now_ns);
  }
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  switch (step()) {
    case Step::kDone:
      return;
    case Step::kDrain:
      enter(Step::kProbe, now_ns);
      return;
    case Step::kPause:
      enter(take_reset() ? Step::kReset : Step::kDrain, now_ns);
      return;
    case Step::kProbe:
      tell_silence(sink);
      rate_.next();
      rate_settled_ = false;
      break;
    case Step::kTime:
      tells_no_time_ = true;
      break;
    default:
      break;
  }
  enter(Step::kDrain, now_ns);
}

void BringUp::on_probe(const Reply& reply, std::int64_t now_ns, LrfSink& sink) {
  if (reply.line(0) != "QT") {
    return;  // the end of what ran before
  }
  count_answer(kProbesMax, sink);
  if (is_scip1(reply)) {
    enter(Step::kSwitch, now_ns);
  } else if (!status_of(reply).ok()) {
    enter(Step::kDrain, now_ns);
  } else if (!is_ok(reply)) {
    enter(Step::kLeaveTimeMode, now_ns);
  } else if (rate_.is_another() && !rate_settled_) {
    enter(Step::kSetRate, now_ns);
  } else {
    enter(Step::kAsk, now_ns);
  }
}

void BringUp::on_rate(const Reply& reply, std::int64_t now_ns) {
  if (!reply.line(0).starts_with("SS")) {
    return;
  }
  const Result<Status> answer = status_of(reply);
  rate_settled_ = answer.ok();
  if (answer.ok() && (answer.value() == status("00") || answer.value() == status("03"))) {
    rate_.switch_over();
  }
  enter(Step::kDrain, now_ns);
}

void BringUp::on_parameters(const Reply& reply, std::int64_t now_ns, LrfSink& sink) {
  if (reply.line(0) != "PP") {
    return;
  }
  const Result<Parameters> parameters = parameters_of(reply);
  const Errc error = parameters.ok() ? stream().configure(parameters.value(), rate_.baud()) : parameters.error();
  if (error != Errc::kOk) {
    refuse(error, now_ns, sink);
  } else if (tells_no_time_) {
    enter(Step::kStart, now_ns);
  } else {
    time_.start(rate_.baud());
    enter(Step::kTime, now_ns);
  }
}

void BringUp::on_time(const Reply& reply, std::int64_t now_ns) {
  if (!time_.on_reply(reply, now_ns)) {
    return;
  }
  if (!time_.done()) {
    enter(Step::kTime, now_ns);
    return;
  }
  if (const std::optional<ClockReading> reading = time_.reading()) {
    stream().compare(*reading);
  }
  enter(Step::kStart, now_ns);
}

void BringUp::on_started(const Reply& reply, std::int64_t now_ns, LrfSink& sink) {
  if (reply.line(0) != stream().echo()) {
    return;
  }
  const Result<Status> answer = status_of(reply);
  if (answer.ok() && (answer.value() == status("00") || answer.value() == status("99"))) {
    finish();
  } else if (answer.ok()) {
    fail(answer.value(), now_ns, sink);
  } else {
    enter(Step::kDrain, now_ns);
  }
}

void BringUp::on_reply(const Reply& reply, std::int64_t now_ns, LrfSink& sink) {
  switch (step()) {
    case Step::kReset:
    case Step::kLeaveTimeMode:
    case Step::kSwitch: {
      const std::string_view request = request_of(step(), now_ns);
      if (reply.line(0) == request.substr(0, request.size() - 1)) {
        enter(step() == Step::kReset ? Step::kDrain : Step::kProbe, now_ns);
      }
      return;
    }
    case Step::kProbe:
      on_probe(reply, now_ns, sink);
      return;
    case Step::kSetRate:
      on_rate(reply, now_ns);
      return;
    case Step::kAsk:
      on_parameters(reply, now_ns, sink);
      return;
    case Step::kTime:
      on_time(reply, now_ns);
      return;
    case Step::kStart:
      on_started(reply, now_ns, sink);
      return;
    case Step::kDrain:
    case Step::kPause:
    case Step::kDone:
      return;
  }
}

}  // namespace odoless::scip
