#include "drivers/lrf/scip/bring_up.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace odoless::scip {
namespace {

constexpr std::int64_t kQuietNs = 60'000'000;        ///< silence after which a line counts as drained
constexpr std::int64_t kDrainMaxNs = 1'000'000'000;  ///< then the next step is tried all the same
constexpr std::int64_t kPauseNs = 1'000'000'000;     ///< before a broken device is asked again
/// That a device answers on its way: SCIP 1.1, time mode, another rate, no time and its mode, and one to spare.
constexpr int kProbesMax = 7;
constexpr std::array<int, 6> kRatesBaud{19200, 57600, 115200, 250000, 500000, 750000};

bool is_ok(const Reply& reply) {
  const Result<Status> answer = status_of(reply);
  return answer.ok() && answer.value() == status("00");
}

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : params_(params), stream_(stream), line_baud_(params.baud) {}

void BringUp::start(std::int64_t now_ns, bool with_reset) {
  silence_told_ = false;
  tells_no_time_ = false;
  probes_answered_ = 0;
  enter(with_reset ? Step::kReset : Step::kDrain, now_ns);
}

std::string_view BringUp::request_of(Step step) {
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
      return stream_.request();
    case Step::kTime:
    case Step::kSetRate:
    case Step::kPause:
    case Step::kDone:
      break;
  }
  return {};
}

void BringUp::send(std::string_view request) {
  std::copy(request.begin(), request.end(), request_.begin());
  request_size_ = request.size();
}

std::string_view BringUp::take_request() { return {request_.data(), std::exchange(request_size_, 0)}; }

void BringUp::enter(Step step, std::int64_t now_ns) {
  step_ = step;
  send(step == Step::kTime ? time_.request(now_ns) : request_of(step));
  if (step == Step::kSetRate) {
    std::array<char, 9> request{'S', 'S', '0', '0', '0', '0', '0', '0', '\n'};
    int rest = params_.baud;
    for (std::size_t i = 7; i >= 2; --i, rest /= 10) {
      request[i] = static_cast<char>('0' + rest % 10);
    }
    send({request.data(), request.size()});
  }
  drain_end_ns_ = now_ns + kDrainMaxNs;
  deadline_ns_ = now_ns + (step == Step::kDrain   ? kQuietNs
                           : step == Step::kPause ? kPauseNs
                                                  : params_.reply_timeout_ns);
}

void BringUp::on_ignored_bytes(std::int64_t now_ns) {
  if (step_ == Step::kDrain) {
    deadline_ns_ = std::min(now_ns + kQuietNs, drain_end_ns_);
  }
}

void BringUp::pause(Errc reason, Status device_status, std::int64_t now_ns, LrfSink& sink) {
  const bool is_device_error = reason == Errc::kDeviceStatus;
  device_errors_ += is_device_error ? 1 : 0;
  sink.on_event({.type = is_device_error ? LrfEventType::kDeviceError : LrfEventType::kRejected,
                 .reason = reason,
                 .device_status = device_status});
  reset_is_due_ = is_device_error;
  probes_answered_ = 0;  // why it does not stream is told
  enter(Step::kPause, now_ns);
}

void BringUp::next_rate() {
  if (params_.baud == 0) {
    return;
  }
  rate_settled_ = false;
  const auto count = static_cast<int>(kRatesBaud.size());
  line_baud_ = rates_tried_ == count ? params_.baud : kRatesBaud[static_cast<std::size_t>(rates_tried_)];
  rates_tried_ = (rates_tried_ + 1) % (count + 1);
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  switch (step_) {
    case Step::kDone:
      return;
    case Step::kDrain:
      enter(Step::kProbe, now_ns);
      return;
    case Step::kPause:
      enter(std::exchange(reset_is_due_, false) ? Step::kReset : Step::kDrain, now_ns);
      return;
    case Step::kProbe:
      if (!std::exchange(silence_told_, true)) {
        sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceSilent});
      }
      next_rate();
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
  if (probes_answered_++ == kProbesMax) {
    sink.on_event({.type = LrfEventType::kUnanswered, .reason = Errc::kDeviceSilent});
  }
  if (is_scip1(reply)) {
    enter(Step::kSwitch, now_ns);
  } else if (!status_of(reply).ok()) {
    enter(Step::kDrain, now_ns);
  } else if (!is_ok(reply)) {
    enter(Step::kLeaveTimeMode, now_ns);
  } else if (params_.baud != line_baud_ && !rate_settled_) {
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
    line_baud_ = params_.baud;
  }
  enter(Step::kDrain, now_ns);
}

void BringUp::on_parameters(const Reply& reply, std::int64_t now_ns, LrfSink& sink) {
  if (reply.line(0) != "PP") {
    return;
  }
  const Result<Parameters> parameters = parameters_of(reply);
  const Errc error = parameters.ok() ? stream_.configure(parameters.value(), line_baud_) : parameters.error();
  if (error != Errc::kOk) {
    pause(error, -1, now_ns, sink);
  } else if (tells_no_time_) {
    enter(Step::kStart, now_ns);
  } else {
    time_.start(line_baud_);
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
    stream_.compare(*reading);
  }
  enter(Step::kStart, now_ns);
}

void BringUp::on_started(const Reply& reply, std::int64_t now_ns, LrfSink& sink) {
  if (reply.line(0) != stream_.echo()) {
    return;
  }
  const Result<Status> answer = status_of(reply);
  if (answer.ok() && (answer.value() == status("00") || answer.value() == status("99"))) {
    step_ = Step::kDone;
    silence_told_ = false;
  } else if (answer.ok()) {
    pause(Errc::kDeviceStatus, answer.value(), now_ns, sink);
  } else {
    enter(Step::kDrain, now_ns);
  }
}

void BringUp::on_reply(const Reply& reply, std::int64_t now_ns, LrfSink& sink) {
  switch (step_) {
    case Step::kReset:
    case Step::kLeaveTimeMode:
    case Step::kSwitch: {
      const std::string_view request = request_of(step_);
      if (reply.line(0) == request.substr(0, request.size() - 1)) {
        enter(step_ == Step::kReset ? Step::kDrain : Step::kProbe, now_ns);
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
