#include "drivers/lrf/rplidar/bring_up.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "drivers/io/device_address.hpp"

namespace odoless::rplidar {
namespace {

constexpr std::int64_t kQuietNs = 60'000'000;        ///< silence after which a line counts as drained
constexpr std::int64_t kDrainMaxNs = 1'000'000'000;  ///< then the next step is tried all the same
constexpr std::int64_t kRebootNs = 1'000'000'000;
constexpr std::int64_t kMotorNs = 10'000'000;  ///< it doesn't answer
constexpr std::int64_t kPauseNs = 1'000'000'000;
constexpr std::array<int, 4> kRatesBaud{115200, 256000, 460800, 1000000};

// What a sample takes where the device doesn't say: the A1's figures.
constexpr std::int64_t kStandardSampleNs = 500'000;
constexpr std::int64_t kExpressSampleNs = 250'000;
constexpr std::int64_t kSampleMinNs = 10'000;
constexpr std::int64_t kSampleMaxNs = 5'000'000;

constexpr int kInfoType = 0x04;
constexpr int kHealthType = 0x06;
constexpr int kSampleTimeType = 0x15;
constexpr int kScanType = 0x81;
constexpr int kExpressType = 0x82;
constexpr int kBroken = 2;

/// The duty that Slamtec gives motors that take it as a command: of the A2 and A3, whose model byte begins with a 2
/// or 3.
constexpr int kUsualDuty = 660;
int usual_duty(std::span<const std::byte> info) {
  const int series = info.empty() ? 0 : std::to_integer<int>(info[0]) >> 4;
  return series == 2 || series == 3 ? kUsualDuty : 0;
}

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : params_(params),
      stream_(stream),
      line_baud_(params.baud == 0 && is_serial(params.device) ? kRatesBaud[0] : params.baud) {}

void BringUp::start(std::int64_t now_ns, bool with_reset) {
  silent_step_ = Step::kDone;
  enter(with_reset ? Step::kReset : Step::kStop, now_ns);
}

Request BringUp::request_of(Step step) const {
  switch (step) {
    case Step::kReset:
      return Request(Command::kReset);
    case Step::kStop:
      return Request(Command::kStop);
    case Step::kAskInfo:
      return Request(Command::kInfo);
    case Step::kAskHealth:
      return Request(Command::kHealth);
    case Step::kAskSampleTime:
      return Request(Command::kSampleTime);
    case Step::kMotor: {
      const std::array<std::byte, 2> duty{static_cast<std::byte>(motor_duty_ & 0xFF),
                                          static_cast<std::byte>(motor_duty_ >> 8)};
      return Request(Command::kMotor, duty);
    }
    case Step::kScan:
      return params_.rplidar_scan == RplidarScan::kStandard ? Request(Command::kScan)
                                                            : Request(Command::kExpress, std::array<std::byte, 5>{});
    case Step::kPause:
    case Step::kDone:
      break;
  }
  return {};
}

std::span<const std::byte> BringUp::take_request() {
  return std::exchange(request_waits_, false) ? request_.bytes() : std::span<const std::byte>{};
}

void BringUp::enter(Step step, std::int64_t now_ns) {
  step_ = step;
  answer_size_ = 0;
  request_ = request_of(step);
  request_waits_ = !request_.bytes().empty();
  drain_end_ns_ = now_ns + kDrainMaxNs;
  deadline_ns_ = now_ns + (step == Step::kStop    ? kQuietNs
                           : step == Step::kReset ? kRebootNs
                           : step == Step::kMotor ? kMotorNs
                           : step == Step::kPause ? kPauseNs
                                                  : params_.reply_timeout_ns);
}

void BringUp::fail(Errc reason, int device_status, std::int64_t now_ns, LrfSink& sink) {
  const bool is_device_error = reason == Errc::kDeviceStatus;
  device_errors_ += is_device_error ? 1 : 0;
  sink.on_event({.type = is_device_error ? LrfEventType::kDeviceError : LrfEventType::kRejected,
                 .reason = reason,
                 .device_status = device_status});
  reset_is_due_ = is_device_error;
  enter(Step::kPause, now_ns);
}

void BringUp::tell_silence(LrfSink& sink) {
  if (std::exchange(silent_step_, step_) != step_) {
    sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceSilent});
  }
}

void BringUp::next_rate() {
  if (params_.baud == 0 && line_baud_ != 0 && !rate_is_known_) {
    rates_tried_ = (rates_tried_ + 1) % static_cast<int>(kRatesBaud.size());
    line_baud_ = kRatesBaud[static_cast<std::size_t>(rates_tried_)];
  }
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  switch (step_) {
    case Step::kDone:
      return;
    case Step::kStop:
      return enter(Step::kAskInfo, now_ns);
    case Step::kAskInfo:
      tell_silence(sink);
      next_rate();
      return enter(Step::kStop, now_ns);
    case Step::kAskSampleTime:
      on_sample_time({});
      return motor_duty_ > 0 ? enter(Step::kMotor, now_ns) : start_stream(now_ns, sink);
    case Step::kMotor:
      return start_stream(now_ns, sink);
    case Step::kPause:
      return enter(std::exchange(reset_is_due_, false) ? Step::kReset : Step::kStop, now_ns);
    case Step::kAskHealth:
    case Step::kScan:  // it answered up to here: it doesn't know that scan
      tell_silence(sink);
      return enter(Step::kStop, now_ns);
    default:
      return enter(Step::kStop, now_ns);
  }
}

void BringUp::start_stream(std::int64_t now_ns, LrfSink& sink) {
  const Errc error = stream_.configure(sample_ns_, line_baud_);
  if (error == Errc::kOk) {
    enter(Step::kScan, now_ns);
  } else {
    fail(error, -1, now_ns, sink);
  }
}

void BringUp::receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink) {
  while (!bytes.empty() && !done()) {
    if (step_ == Step::kStop || step_ == Step::kReset || step_ == Step::kPause || step_ == Step::kMotor) {
      deadline_ns_ = step_ == Step::kStop ? std::min(now_ns + kQuietNs, drain_end_ns_) : deadline_ns_;
      bytes = {};
      return;
    }
    answer_[answer_size_++] = bytes.front();
    bytes = bytes.subspan(1);
    const std::span<const std::byte> have = std::span(answer_).first(answer_size_);
    if ((answer_size_ == 1 && have[0] != std::byte{0xA5}) || (answer_size_ == 2 && have[1] != std::byte{0x5A})) {
      answer_[0] = have.back();
      answer_size_ = have.back() == std::byte{0xA5} ? 1 : 0;
      continue;
    }
    const std::optional<Descriptor> descriptor = descriptor_of(have);
    if (!descriptor) {
      continue;
    }
    if (!descriptor->is_stream && descriptor->length_bytes > kAnswerMaxBytes - kDescriptorBytes) {
      answer_size_ = 0;
    } else if (descriptor->is_stream || answer_size_ == kDescriptorBytes + descriptor->length_bytes) {
      answer_size_ = 0;
      on_answer(*descriptor, have.subspan(kDescriptorBytes), now_ns, sink);
    }
  }
}

void BringUp::on_sample_time(std::span<const std::byte> data) {
  const bool is_standard = params_.rplidar_scan == RplidarScan::kStandard;
  const std::size_t at = is_standard ? 0 : 2;
  std::int64_t told_ns = 0;
  if (data.size() == 4) {
    told_ns = (std::to_integer<std::int64_t>(data[at]) + 256 * std::to_integer<std::int64_t>(data[at + 1])) * 1000;
  }
  const bool can_be = told_ns >= kSampleMinNs && told_ns <= kSampleMaxNs;
  sample_ns_ = can_be ? told_ns : is_standard ? kStandardSampleNs : kExpressSampleNs;
}

void BringUp::on_answer(const Descriptor& descriptor, std::span<const std::byte> data, std::int64_t now_ns,
                        LrfSink& sink) {
  switch (step_) {
    case Step::kAskInfo:
      if (descriptor.type != kInfoType) {
        return enter(Step::kStop, now_ns);
      }
      motor_duty_ = params_.rplidar_pwm > 0 ? params_.rplidar_pwm : usual_duty(data);
      return enter(Step::kAskHealth, now_ns);
    case Step::kAskHealth: {
      if (descriptor.type != kHealthType || data.size() != 3) {
        return enter(Step::kStop, now_ns);
      }
      const int status = std::to_integer<int>(data[0]);
      return status >= kBroken ? fail(Errc::kDeviceStatus, status, now_ns, sink) : enter(Step::kAskSampleTime, now_ns);
    }
    case Step::kAskSampleTime:
      on_sample_time(descriptor.type == kSampleTimeType ? data : std::span<const std::byte>{});
      return motor_duty_ > 0 ? enter(Step::kMotor, now_ns) : start_stream(now_ns, sink);
    case Step::kScan: {
      const bool is_standard = params_.rplidar_scan == RplidarScan::kStandard;
      const bool is_right = descriptor.is_stream && descriptor.type == (is_standard ? kScanType : kExpressType) &&
                            descriptor.length_bytes == (is_standard ? kNodeBytes : kCapsuleBytes);
      if (!is_right) {
        return fail(Errc::kFrameMalformed, -1, now_ns, sink);
      }
      step_ = Step::kDone;
      rate_is_known_ = true;
      silent_step_ = Step::kDone;
      return;
    }
    default:
      return;
  }
}

}  // namespace odoless::rplidar
