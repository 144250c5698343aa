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
constexpr int kNaksMax = 3;
constexpr int kDeafRoundsMax = 5;
constexpr int kStopsMax = 3;  ///< that a device answers on its way: at two rates, and one to spare

constexpr std::array kRatesBaud{9600, 19200, 38400, 500000};
constexpr std::array kRateCommands{0x42, 0x41, 0x40, 0x48};

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
    : BringUpSteps(params, stream),
      rate_(params.baud, is_serial(params.device) ? kRatesBaud : std::span<const int>{}) {}

void BringUp::start(std::int64_t now_ns, bool with_reset) {
  begin();
  deaf_rounds_ = 0;
  enter(with_reset ? Step::kReset : Step::kStop, now_ns);
}

std::int64_t BringUp::patience_ns(Step step) const {
  switch (step) {
    case Step::kStop:
      return params().reply_timeout_ns;
    case Step::kAskStatus:
    case Step::kAskConfiguration:
      return std::max(params().reply_timeout_ns, kLongReplyNs);
    case Step::kConfigure:
      return kWriteNs;
    case Step::kSettle:
      return kSettleNs;
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
      put(kSetVariant, stream().variant().field_of_view_cdeg / 100, 0, stream().variant().step_cdeg, 0);
      break;
    case Step::kSetRate:
      put(kSetMode,
          kRateCommands[static_cast<std::size_t>(std::ranges::find(kRatesBaud, params().baud) - kRatesBaud.begin())]);
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
  send(request_.bytes());
}

void BringUp::enter(Step step, std::int64_t now_ns) {
  naks_ = 0;
  heard_ = false;
  wait(step, now_ns + patience_ns(step));
  send_request_of(step);
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  switch (step()) {
    case Step::kDone:
      return;
    case Step::kPause:
      enter(take_reset() && !only_asks_ ? Step::kReset : Step::kStop, now_ns);
      return;
    case Step::kStop:
      if (heard_ && deaf_rounds_ < kDeafRoundsMax) {
        ++deaf_rounds_;
        break;
      }
      tell_silence(sink);
      deaf_rounds_ = 0;
      rate_.next();
      break;
    default:
      break;
  }
  enter(Step::kStop, now_ns);
}

void BringUp::on_nak(std::int64_t now_ns) {
  if (step() != Step::kDone && step() != Step::kPause && ++naks_ <= kNaksMax) {
    wait(step(), now_ns + patience_ns(step()));
    send_request_of(step());
  }
}

bool BringUp::answers(const Telegram& telegram) const {
  switch (step()) {
    case Step::kReset:
      return telegram.command() == kPowerOn;  // after its word that it begins, which comes too soon
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
  } else if (step() == Step::kStop && !heard_) {
    heard_ = true;
    wait_longer(now_ns + kHeardNs);
  }
}

void BringUp::on_answer(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  const std::span<const std::byte> data = telegram.data();
  const int result = data.empty() ? -1 : std::to_integer<int>(data[0]);
  switch (step()) {
    case Step::kReset:
      return enter(Step::kStop, now_ns);
    case Step::kStop:
      deaf_rounds_ = 0;
      count_answer(kStopsMax, sink);
      return enter(Step::kAskStatus, now_ns);
    case Step::kAskStatus:
      return on_status(telegram, now_ns, sink);
    case Step::kAskConfiguration:
      return on_configuration(telegram, now_ns, sink);
    case Step::kConfigure:
      return result == 1 ? enter(Step::kLeaveInstallation, now_ns) : fail(result, now_ns, sink);
    case Step::kSetVariant:
      return result == 1 ? on_variant_set(now_ns, sink) : fail(result, now_ns, sink);
    case Step::kSetRate:
      rate_refused_ = result != 0;
      if (!rate_refused_) {
        rate_.switch_over();
      }
      return enter(Step::kSettle, now_ns);
    default:
      break;
  }
  if (result != 0) {  // of the answers to a change of the mode
    return fail(result, now_ns, sink);
  }
  switch (step()) {
    case Step::kInstall:
      return enter(Step::kConfigure, now_ns);
    case Step::kLeaveInstallation:
      return enter(Step::kSetVariant, now_ns);
    case Step::kStart:
      return finish();
    default:
      return;
  }
}

void BringUp::on_status(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  if (severity(telegram) >= kFatal) {
    return fail(telegram.status(), now_ns, sink);
  }
  if (only_asks_) {
    const std::span<const std::byte> data = telegram.data();
    if (data.size() < kResolution + 2) {
      return refuse(Errc::kFrameTruncated, now_ns, sink);
    }
    const std::optional<SickVariant> variant = variant_named(number(data[kFieldOfView], data[kFieldOfView + 1]),
                                                             number(data[kResolution], data[kResolution + 1]));
    if (!variant) {
      return refuse(Errc::kFrameMalformed, now_ns, sink);
    }
    found_.variant = *variant;
  }
  enter(Step::kAskConfiguration, now_ns);
}

void BringUp::on_configuration(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  const std::span<const std::byte> data = telegram.data();
  if (data.size() < kUnit + 1) {
    return refuse(Errc::kFrameTruncated, now_ns, sink);
  }
  if (only_asks_) {
    found_.unit = data[kUnit] == unit_code_of(SickUnit::kMm) ? SickUnit::kMm : SickUnit::kCm;
    found_.is_usual_mode = data[kMeasuringMode] == measuring_mode_of(found_.unit);
    stream().take_over(found_.variant, found_.unit);
    if (const Errc error = stream().configure(rate_.baud()); error != Errc::kOk) {
      return refuse(error, now_ns, sink);
    }
    return finish();
  }
  configuration_ = {};
  std::copy_n(data.begin(), std::min(data.size(), configuration_.size()), configuration_.begin());
  const bool is_wished = configuration_[kUnit] == unit_code_of(params().sick_unit) &&
                         configuration_[kMeasuringMode] == measuring_mode_of(params().sick_unit);
  configuration_[kUnit] = unit_code_of(params().sick_unit);
  configuration_[kMeasuringMode] = measuring_mode_of(params().sick_unit);
  enter(is_wished ? Step::kSetVariant : Step::kInstall, now_ns);
}

void BringUp::on_variant_set(std::int64_t now_ns, LrfSink& sink) {
  const bool is_rate = std::ranges::find(kRatesBaud, params().baud) != kRatesBaud.end();
  if (is_rate && rate_.is_another() && !rate_refused_) {
    return enter(Step::kSetRate, now_ns);
  }
  if (const Errc error = stream().configure(rate_.baud()); error != Errc::kOk) {
    return refuse(error, now_ns, sink);
  }
  enter(Step::kStart, now_ns);
}

}  // namespace odoless::sick
