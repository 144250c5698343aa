#include "drivers/lrf/rplidar/bring_up.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "drivers/lrf/rplidar/bytes.hpp"

namespace odoless::rplidar {
namespace {

constexpr std::int64_t kRebootNs = 1'000'000'000;
constexpr std::int64_t kMotorNs = 10'000'000;  ///< it doesn't answer
constexpr std::array<int, 4> kRatesBaud{115200, 256000, 460800, 1000000};

// What a sample takes where the device doesn't say: the A1's figures.
constexpr std::int64_t kStandardSampleNs = 500'000;
constexpr std::int64_t kExpressSampleNs = 250'000;
constexpr std::int64_t kSampleMinNs = 10'000;
constexpr std::int64_t kSampleMaxNs = 5'000'000;

constexpr int kInfoType = 0x04;
constexpr int kHealthType = 0x06;
constexpr int kSampleTimeType = 0x15;
constexpr int kSettingType = 0x20;
constexpr std::size_t kSettingKeyBytes = 4;
constexpr int kBroken = 2;

// By every device that has a list of modes.
constexpr int kStandardMode = 0;
constexpr int kExpressMode = 1;

constexpr int kUsualDuty = 660;          ///< of an A2 or A3 that doesn't tell
constexpr int kSpeedRpmSeries = 6;       ///< S1; those before have a motor that takes its duty or no command at all
constexpr std::array kDutySeries{2, 3};  ///< A2, A3

bool can_be_sample(std::int64_t sample_ns) { return sample_ns >= kSampleMinNs && sample_ns <= kSampleMaxNs; }

Request with_number(Command command, int number) {
  return Request(command, std::array{static_cast<std::byte>(number & 0xFF), static_cast<std::byte>(number >> 8)});
}
Request question(Setting setting, int mode = 0) {
  std::array<std::byte, 6> payload{};
  payload[0] = static_cast<std::byte>(setting);
  payload[4] = static_cast<std::byte>(mode & 0xFF);
  payload[5] = static_cast<std::byte>(mode >> 8);
  return Request(Command::kSetting, payload);
}

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : BringUpSteps(params, stream), rate_(params, kRatesBaud) {}

void BringUp::start(std::int64_t now_ns, bool with_reset) {
  begin();
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
    case Step::kAskUsualMode:
      return question(Setting::kUsualMode);
    case Step::kAskModeSample:
      return question(Setting::kModeSample, mode_);
    case Step::kAskModeAnswer:
      return question(Setting::kModeAnswer, mode_);
    case Step::kAskModeRange:
      return question(Setting::kModeRange, mode_);
    case Step::kAskSpeed:
      return question(Setting::kUsualSpeed);
    case Step::kMotor:
      return duty_ > 0 ? with_number(Command::kMotorDuty, duty_) : with_number(Command::kMotorSpeed, speed_rpm_);
    case Step::kScan:
      return is_standard_ ? Request(Command::kScan)
                          : Request(Command::kExpress, std::array<std::byte, 5>{static_cast<std::byte>(mode_)});
    case Step::kPause:
    case Step::kDone:
      break;
  }
  return {};
}

void BringUp::enter(Step step, std::int64_t now_ns) {
  answer_size_ = 0;
  request_ = request_of(step);
  if (step == Step::kStop) {
    drain(step, now_ns);
  } else {
    wait(step, now_ns + (step == Step::kReset   ? kRebootNs
                         : step == Step::kMotor ? kMotorNs
                                                : params().reply_timeout_ns));
  }
  send(request_.bytes());
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  switch (step()) {
    case Step::kDone:
      return;
    case Step::kStop:
      return enter(Step::kAskInfo, now_ns);
    case Step::kAskInfo:
      if (rate_.next()) {
        tell_silence(sink);
      }
      return enter(Step::kStop, now_ns);
    case Step::kAskUsualMode:
    case Step::kAskModeSample:  // it has no list
      return enter(Step::kAskSampleTime, now_ns);
    case Step::kAskSampleTime:
      on_sample_time({});
      return ask_for_speed(now_ns);
    case Step::kAskModeRange:
    case Step::kAskSpeed:
      return on_setting({}, now_ns, sink);
    case Step::kMotor:
      return enter(Step::kScan, now_ns);
    case Step::kPause:
      return enter(take_reset() ? Step::kReset : Step::kStop, now_ns);
    case Step::kAskHealth:
    case Step::kAskModeAnswer:
    case Step::kScan:  // it answered up to here: it doesn't know that scan
      tell_silence(sink);
      return enter(Step::kStop, now_ns);
    default:
      return enter(Step::kStop, now_ns);
  }
}

void BringUp::receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink) {
  while (!bytes.empty() && !done()) {
    if (step() == Step::kStop) {
      drain_on(now_ns);
    }
    if (step() == Step::kStop || step() == Step::kReset || step() == Step::kPause || step() == Step::kMotor) {
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

void BringUp::on_info(std::span<const std::byte> data, std::int64_t now_ns) {
  Info info{};
  std::copy_n(data.begin(), std::min(data.size(), info.size()), info.begin());
  is_known_ = is_known_ && info == info_;
  info_ = info;
  series_ = static_cast<int>(byte_at(data, 0) >> 4U);
  enter(Step::kAskHealth, now_ns);
}

/// Which mode is wished for by its number, or the device's own choice.
void BringUp::ask_for_mode(std::int64_t now_ns) {
  if (std::exchange(is_known_, false)) {  // until it streams again
    return turn_motor(now_ns);
  }
  has_modes_ = false;
  told_all_ = true;
  scan_mode_ = {};
  mode_ = params().rplidar_scan == RplidarScan::kExpress ? kExpressMode : kStandardMode;
  enter(params().rplidar_scan == RplidarScan::kUsual ? Step::kAskUsualMode : Step::kAskModeSample, now_ns);
}

/// Of a device without a list of modes: what a sample takes in both of its scans, or nothing of one that knows the
/// standard scan alone.
void BringUp::on_sample_time(std::span<const std::byte> data) {
  const bool is_told = data.size() == 4;
  is_standard_ =
      params().rplidar_scan == RplidarScan::kStandard || (params().rplidar_scan == RplidarScan::kUsual && !is_told);
  mode_ = 0;  // by which older devices know the express scan
  const std::int64_t told_ns = is_told ? number_at(data, is_standard_ ? 0 : 2) * std::int64_t{1000} : 0;
  scan_mode_.sample_ns = can_be_sample(told_ns) ? told_ns : is_standard_ ? kStandardSampleNs : kExpressSampleNs;
}

/// The value of the setting that was asked for; empty: it has none.
void BringUp::on_setting(std::span<const std::byte> value, std::int64_t now_ns, LrfSink& sink) {
  told_all_ = told_all_ && !value.empty();
  switch (step()) {
    case Step::kAskUsualMode:
      mode_ = value.size() >= 2 ? static_cast<int>(number_at(value, 0)) : -1;
      return enter(mode_ >= 0 && mode_ <= 0xFF ? Step::kAskModeSample : Step::kAskSampleTime, now_ns);
    case Step::kAskModeSample:
      scan_mode_.sample_ns = value.size() >= 4 ? long_at(value, 0) * std::int64_t{1000} / 256 : 0;
      return enter(can_be_sample(scan_mode_.sample_ns) ? Step::kAskModeAnswer : Step::kAskSampleTime, now_ns);
    case Step::kAskModeAnswer: {
      const int type = value.empty() ? 0 : static_cast<int>(byte_at(value, 0));
      is_standard_ = type == kNodeType;
      if (is_standard_ || find_capsule_format(type) != nullptr) {
        has_modes_ = true;
        return enter(Step::kAskModeRange, now_ns);
      }
      if (mode_ == kStandardMode) {
        return refuse(Errc::kFrameMalformed, now_ns, sink);
      }
      mode_ = kStandardMode;  // packets that we don't know
      return enter(Step::kAskModeSample, now_ns);
    }
    case Step::kAskModeRange:
      scan_mode_.range_max_m = value.size() >= 4 ? long_at(value, 0) / 256.0 : 0.0;
      return ask_for_speed(now_ns);
    default:  // the speed
      speed_rpm_ = value.size() >= 4 ? static_cast<int>(number_at(value, 0)) : 0;
      duty_ = value.size() >= 4 ? static_cast<int>(number_at(value, 2)) : kUsualDuty;
      duty_ = series_ >= kSpeedRpmSeries ? 0 : duty_;
      return turn_motor(now_ns);
  }
}

void BringUp::ask_for_speed(std::int64_t now_ns) {
  speed_rpm_ = 0;
  duty_ = params().rplidar_pwm;
  const bool takes_duty = std::ranges::find(kDutySeries, series_) != kDutySeries.end();
  if (duty_ == 0 && takes_duty && !has_modes_) {
    duty_ = kUsualDuty;
  }
  const bool is_asked = duty_ == 0 && (takes_duty || series_ >= kSpeedRpmSeries);
  return is_asked ? enter(Step::kAskSpeed, now_ns) : turn_motor(now_ns);
}

void BringUp::turn_motor(std::int64_t now_ns) {
  enter(duty_ > 0 || (series_ >= kSpeedRpmSeries && speed_rpm_ > 0) ? Step::kMotor : Step::kScan, now_ns);
}

void BringUp::on_stream(const Descriptor& descriptor, std::int64_t now_ns, LrfSink& sink) {
  scan_mode_.format = find_capsule_format(descriptor.type);
  const bool is_known = is_standard_ ? descriptor.type == kNodeType : scan_mode_.format != nullptr;
  const std::size_t bytes = is_standard_ ? kNodeBytes : scan_mode_.format != nullptr ? scan_mode_.format->bytes : 0;
  if (!descriptor.is_stream || !is_known || descriptor.length_bytes != bytes) {
    return refuse(Errc::kFrameMalformed, now_ns, sink);
  }
  if (const Errc error = stream().configure(scan_mode_, rate_.baud()); error != Errc::kOk) {
    return refuse(error, now_ns, sink);
  }
  is_known_ = has_modes_ && told_all_;
  rate_.found();
  finish();
}

void BringUp::on_answer(const Descriptor& descriptor, std::span<const std::byte> data, std::int64_t now_ns,
                        LrfSink& sink) {
  switch (step()) {
    case Step::kAskInfo:
      return descriptor.type == kInfoType && !data.empty() ? on_info(data, now_ns) : enter(Step::kStop, now_ns);
    case Step::kAskHealth: {
      if (descriptor.type != kHealthType || data.size() != 3) {
        return enter(Step::kStop, now_ns);
      }
      const int status = static_cast<int>(byte_at(data, 0));
      return status >= kBroken ? fail(status, now_ns, sink) : ask_for_mode(now_ns);
    }
    case Step::kAskSampleTime:
      on_sample_time(descriptor.type == kSampleTimeType ? data : std::span<const std::byte>{});
      return ask_for_speed(now_ns);
    case Step::kScan:
      return on_stream(descriptor, now_ns, sink);
    default: {
      const bool is_it =
          descriptor.type == kSettingType && data.size() >= kSettingKeyBytes &&
          std::ranges::equal(data.first(kSettingKeyBytes), request_.bytes().subspan(3, kSettingKeyBytes));
      return is_it ? on_setting(data.subspan(kSettingKeyBytes), now_ns, sink) : enter(Step::kStop, now_ns);
    }
  }
}

}  // namespace odoless::rplidar
