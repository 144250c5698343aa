#include "drivers/lrf/sick/bring_up.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "drivers/io/device_address.hpp"

namespace odoless::sick {
namespace {

/// The status takes 174 ms at 9600 baud, its request included, after up to 60 ms of thinking; others wait as long.
constexpr std::int64_t kLongReplyNs = 1'000'000'000;
constexpr std::int64_t kModeNs = 3'000'000'000;    ///< the device may take this long to change its mode
constexpr std::int64_t kWriteNs = 15'000'000'000;  ///< ... to write its configuration
constexpr std::int64_t kHeardNs = 1'000'000'000;   ///< a scan on its way at 9600 baud holds an answer up
constexpr std::int64_t kSettleNs = 100'000'000;    ///< from the answer to the new rate
constexpr std::int64_t kPauseNs = 1'000'000'000;   ///< before a broken device is asked again
constexpr int kNaksMax = 3;
constexpr int kDeafRoundsMax = 5;
constexpr int kStopsMax = 3;  ///< that a device answers on its way: at two rates, and one to spare

struct Rate {
  int baud;
  int command;
};
constexpr std::array<Rate, 4> kRates{{{9600, 0x42}, {19200, 0x41}, {38400, 0x40}, {500000, 0x48}}};

constexpr int kReset = 0x10;
constexpr int kSetMode = 0x20;
constexpr int kAskStatus = 0x31;
constexpr int kSetVariant = 0x3B;
constexpr int kAskConfiguration = 0x74;
constexpr int kConfigure = 0x77;
constexpr int kAnswer = 0x80;  ///< is added to what was asked

constexpr int kInstallationMode = 0x00;
constexpr int kContinuousMode = 0x24;
constexpr int kRequestMode = 0x25;

// Of the status's data.
constexpr std::size_t kFieldOfView = 106;
constexpr std::size_t kResolution = 108;

// Of the configuration's data.
constexpr std::size_t kMeasuringMode = 5;
constexpr std::size_t kUnit = 6;

constexpr int kFatal = 4;
int severity(const Telegram& telegram) { return telegram.status() & 0x07; }

std::optional<SickVariant> variant_named(unsigned field_of_view_deg, unsigned step_cdeg) {
  for (const SickVariant name : {SickVariant::k180By1, SickVariant::k180ByHalf, SickVariant::k100By1,
                                 SickVariant::k100ByHalf, SickVariant::k100ByQuarter}) {
    const Variant variant = variant_of(name);
    if (variant.field_of_view_cdeg == static_cast<int>(field_of_view_deg) * 100 &&
        variant.step_cdeg == static_cast<int>(step_cdeg)) {
      return name;
    }
  }
  return {};
}

std::byte measuring_mode_of(SickUnit unit) { return unit == SickUnit::kMm ? std::byte{0x06} : std::byte{0x00}; }
std::byte unit_code_of(SickUnit unit) { return unit == SickUnit::kMm ? std::byte{0x01} : std::byte{0x00}; }

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : params_(params),
      sets_rate_(is_serial(params.device)),
      stream_(stream),
      line_baud_(params.baud == 0 && sets_rate_ ? kRates[0].baud : params.baud),
      wished_baud_(sets_rate_ ? params.baud : 0) {}

void BringUp::start(std::int64_t now_ns, bool with_reset) {
  silence_told_ = false;
  deaf_rounds_ = 0;
  stops_answered_ = 0;
  enter(with_reset ? Step::kReset : Step::kStop, now_ns);
}

std::int64_t BringUp::patience_ns(Step step) const {
  switch (step) {
    case Step::kStop:
      return params_.reply_timeout_ns;
    case Step::kAskStatus:
    case Step::kAskConfiguration:
      return std::max(params_.reply_timeout_ns, kLongReplyNs);
    case Step::kConfigure:
      return kWriteNs;
    case Step::kSettle:
      return kSettleNs;
    case Step::kPause:
      return kPauseNs;
    default:
      return kModeNs;
  }
}

void BringUp::send_request_of(Step step) {
  std::array<std::byte, kConfigurationBytes + 1> payload{};
  std::size_t size = 0;
  const auto put = [&](auto... values) { ((payload[size++] = static_cast<std::byte>(values)), ...); };
  switch (step) {
    case Step::kReset:
      put(kReset);
      break;
    case Step::kStop:
    case Step::kLeaveInstallation:
      put(kSetMode, kRequestMode);
      break;
    case Step::kAskStatus:
      put(kAskStatus);
      break;
    case Step::kAskConfiguration:
      put(kAskConfiguration);
      break;
    case Step::kInstall:
      put(kSetMode, kInstallationMode, 'S', 'I', 'C', 'K', '_', 'L', 'M', 'S');
      break;
    case Step::kConfigure:
      put(kConfigure);
      size = static_cast<std::size_t>(std::copy(configuration_.begin(), configuration_.end(), payload.begin() + 1) -
                                      payload.begin());
      break;
    case Step::kSetVariant:
      put(kSetVariant, stream_.variant().field_of_view_cdeg / 100, 0, stream_.variant().step_cdeg, 0);
      break;
    case Step::kSetRate:
      put(kSetMode, std::find_if(kRates.begin(), kRates.end(), [&](const Rate& rate) {
                      return rate.baud == wished_baud_;
                    })->command);
      break;
    case Step::kStart:
      put(kSetMode, kContinuousMode);
      break;
    case Step::kSettle:
    case Step::kPause:
    case Step::kDone:
      return;
  }
  request_ = Request({payload.data(), size});
  request_waits_ = true;
}

std::span<const std::byte> BringUp::take_request() {
  return std::exchange(request_waits_, false) ? request_.bytes() : std::span<const std::byte>{};
}

void BringUp::enter(Step step, std::int64_t now_ns) {
  step_ = step;
  naks_ = 0;
  heard_ = false;
  request_waits_ = false;
  send_request_of(step);
  deadline_ns_ = now_ns + patience_ns(step);
}

void BringUp::fail(Errc reason, int device_status, std::int64_t now_ns, LrfSink& sink) {
  const bool is_device_error = reason == Errc::kDeviceStatus;
  device_errors_ += is_device_error ? 1 : 0;
  sink.on_event({.type = is_device_error ? LrfEventType::kDeviceError : LrfEventType::kRejected,
                 .reason = reason,
                 .device_status = device_status});
  reset_is_due_ = is_device_error && !only_asks_;
  stops_answered_ = 0;  // why it does not stream is told
  enter(Step::kPause, now_ns);
}

void BringUp::next_rate() {
  deaf_rounds_ = 0;
  if (!sets_rate_) {
    return;
  }
  const auto count = static_cast<int>(kRates.size());
  const bool tries_wished = rates_tried_ == count;
  line_baud_ =
      tries_wished && wished_baud_ != 0 ? wished_baud_ : kRates[static_cast<std::size_t>(rates_tried_ % count)].baud;
  rates_tried_ = (rates_tried_ + 1) % (count + 1);
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  switch (step_) {
    case Step::kDone:
      return;
    case Step::kPause:
      enter(std::exchange(reset_is_due_, false) ? Step::kReset : Step::kStop, now_ns);
      return;
    case Step::kStop:
      if (heard_ && deaf_rounds_ < kDeafRoundsMax) {
        ++deaf_rounds_;
        break;
      }
      if (!std::exchange(silence_told_, true)) {
        sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceSilent});
      }
      next_rate();
      break;
    default:
      break;
  }
  enter(Step::kStop, now_ns);
}

void BringUp::on_nak(std::int64_t now_ns) {
  if (step_ != Step::kDone && ++naks_ <= kNaksMax) {
    send_request_of(step_);
    deadline_ns_ = now_ns + patience_ns(step_);
  }
}

bool BringUp::answers(const Telegram& telegram) const {
  switch (step_) {
    case Step::kReset:
      return telegram.command() == kAnswer + kReset || telegram.command() == 0x90;  // it says that it is on
    case Step::kAskStatus:
      return telegram.command() == kAnswer + kAskStatus;
    case Step::kAskConfiguration:
      return telegram.command() == kAnswer + kAskConfiguration;
    case Step::kConfigure:
      return telegram.command() == kAnswer + kConfigure;
    case Step::kSetVariant:
      return telegram.command() == kAnswer + kSetVariant;
    case Step::kSettle:
    case Step::kPause:
    case Step::kDone:
      return false;
    default:
      return telegram.command() == kAnswer + kSetMode;
  }
}

void BringUp::on_telegram(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  if (answers(telegram)) {
    on_answer(telegram, now_ns, sink);
  } else if (step_ == Step::kStop && !heard_) {
    heard_ = true;
    deadline_ns_ = std::max(deadline_ns_, now_ns + kHeardNs);
  }
}

void BringUp::on_answer(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  const std::span<const std::byte> data = telegram.data();
  const int result = data.empty() ? -1 : std::to_integer<int>(data[0]);
  switch (step_) {
    case Step::kReset:
      return enter(Step::kStop, now_ns);
    case Step::kStop:
      deaf_rounds_ = 0;
      if (stops_answered_++ == kStopsMax) {
        sink.on_event({.type = LrfEventType::kUnanswered, .reason = Errc::kDeviceSilent});
      }
      return enter(Step::kAskStatus, now_ns);
    case Step::kAskStatus:
      return on_status(telegram, now_ns, sink);
    case Step::kAskConfiguration:
      return on_configuration(telegram, now_ns, sink);
    case Step::kConfigure:
      return result == 1 ? enter(Step::kLeaveInstallation, now_ns) : fail(Errc::kDeviceStatus, result, now_ns, sink);
    case Step::kSetVariant:
      return result == 1 ? on_variant_set(now_ns, sink) : fail(Errc::kDeviceStatus, result, now_ns, sink);
    case Step::kSetRate:
      rate_refused_ = result != 0;
      line_baud_ = rate_refused_ ? line_baud_ : wished_baud_;
      return enter(Step::kSettle, now_ns);
    default:
      break;
  }
  if (result != 0) {  // of the answers to a change of the mode
    return fail(Errc::kDeviceStatus, result, now_ns, sink);
  }
  switch (step_) {
    case Step::kInstall:
      return enter(Step::kConfigure, now_ns);
    case Step::kLeaveInstallation:
      return enter(Step::kSetVariant, now_ns);
    case Step::kStart:
      step_ = Step::kDone;
      silence_told_ = false;
      return;
    default:
      return;
  }
}

void BringUp::on_status(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  if (severity(telegram) >= kFatal) {
    return fail(Errc::kDeviceStatus, telegram.status(), now_ns, sink);
  }
  if (only_asks_) {
    const std::span<const std::byte> data = telegram.data();
    if (data.size() < kResolution + 2) {
      return fail(Errc::kFrameTruncated, -1, now_ns, sink);
    }
    const std::optional<SickVariant> variant = variant_named(number(data[kFieldOfView], data[kFieldOfView + 1]),
                                                             number(data[kResolution], data[kResolution + 1]));
    if (!variant) {
      return fail(Errc::kFrameMalformed, -1, now_ns, sink);
    }
    found_.variant = *variant;
  }
  enter(Step::kAskConfiguration, now_ns);
}

void BringUp::on_configuration(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  const std::span<const std::byte> data = telegram.data();
  if (data.size() < kUnit + 1) {
    return fail(Errc::kFrameTruncated, -1, now_ns, sink);
  }
  if (only_asks_) {
    found_.unit = data[kUnit] == unit_code_of(SickUnit::kMm) ? SickUnit::kMm : SickUnit::kCm;
    found_.is_usual_mode = data[kMeasuringMode] == measuring_mode_of(found_.unit);
    stream_.take_over(found_.variant, found_.unit);
    if (const Errc error = stream_.configure(line_baud_); error != Errc::kOk) {
      return fail(error, -1, now_ns, sink);
    }
    step_ = Step::kDone;
    return;
  }
  configuration_ = {};
  std::copy_n(data.begin(), std::min(data.size(), configuration_.size()), configuration_.begin());
  const bool is_wished = configuration_[kUnit] == unit_code_of(params_.sick_unit) &&
                         configuration_[kMeasuringMode] == measuring_mode_of(params_.sick_unit);
  configuration_[kUnit] = unit_code_of(params_.sick_unit);
  configuration_[kMeasuringMode] = measuring_mode_of(params_.sick_unit);
  enter(is_wished ? Step::kSetVariant : Step::kInstall, now_ns);
}

void BringUp::on_variant_set(std::int64_t now_ns, LrfSink& sink) {
  const bool is_rate = std::any_of(kRates.begin(), kRates.end(), [&](const Rate& r) { return r.baud == wished_baud_; });
  if (is_rate && wished_baud_ != line_baud_ && !rate_refused_) {
    return enter(Step::kSetRate, now_ns);
  }
  if (const Errc error = stream_.configure(line_baud_); error != Errc::kOk) {
    return fail(error, -1, now_ns, sink);
  }
  enter(Step::kStart, now_ns);
}

}  // namespace odoless::sick
