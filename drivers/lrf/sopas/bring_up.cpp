#include "drivers/lrf/sopas/bring_up.hpp"

#include <algorithm>
#include <utility>

namespace odoless::sopas {
namespace {

constexpr int kUsualBaud = 57600;  ///< of a device that is on a serial line
constexpr std::int64_t kAnswerNs = 1'000'000'000;
constexpr std::int64_t kSetNs = 5'000'000'000;        ///< its mirror changes its speed
constexpr std::int64_t kFirstScanNs = 2'000'000'000;  ///< the same
constexpr int kDialects = 2;
constexpr int kStopsMax = 3;  ///< that a device answers, and then nothing else
constexpr int kAuthorizedClient = 3;
constexpr std::uint32_t kPassword = 0xF4724744;  ///< of authorized clients, as every device is delivered

constexpr std::int32_t kWholeStartTmdeg = -450'000;
constexpr std::int32_t kWholeStopTmdeg = 2'250'000;

struct ScanSetting {
  std::uint32_t rate_chz;  ///< hundredths
  std::uint32_t step_tmdeg;
};

/// @return  Zeros: as the device is set.
ScanSetting setting_of(SopasScan wished) {
  switch (wished) {
    case SopasScan::k25HzByQuarter:
      return {2500, 2500};
    case SopasScan::k50HzByHalf:
      return {5000, 5000};
    case SopasScan::kAsSet:
      break;
  }
  return {0, 0};
}

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream)
    : BringUpSteps(params, stream), line_baud_(params.baud == 0 ? kUsualBaud : params.baud) {}

void BringUp::start(std::int64_t now_ns, bool /*with_reset*/) {
  begin();
  silences_ = 0;
  enter(Step::kStop, now_ns);
}

std::string_view BringUp::head_of(Step step) {
  switch (step) {
    case Step::kStop:
    case Step::kStart:
      return "sEN LMDscandata";
    case Step::kLogIn:
      return "sMN SetAccessMode";
    case Step::kAskScan:
      return "sRN LMPscancfg";
    case Step::kSetScan:
      return "sMN mLMPsetscancfg";
    case Step::kSetContent:
      return "sWN LMDscandatacfg";
    case Step::kMeasure:
      return "sMN LMCstartmeas";
    case Step::kRun:
      return "sMN Run";
    case Step::kFirstScan:
    case Step::kPause:
    case Step::kDone:
      break;
  }
  return {};
}

void BringUp::send_request_of(Step step) {
  if (head_of(step).empty()) {
    return;
  }
  request_ = Request(dialect_, head_of(step));
  const ScanSetting scan = setting_of(params().sopas_scan);
  switch (step) {
    case Step::kStop:
      request_.number(0, 1);
      break;
    case Step::kStart:
      request_.number(1, 1);
      break;
    case Step::kLogIn:
      request_.number(kAuthorizedClient, 1, 2).number(kPassword, 4);
      break;
    case Step::kSetScan:
      request_.number(scan.rate_chz, 4).number(1, 2).number(scan.step_tmdeg, 4);
      request_.number(static_cast<std::uint32_t>(kWholeStartTmdeg), 4);
      request_.number(static_cast<std::uint32_t>(kWholeStopTmdeg), 4);
      break;
    case Step::kSetContent:
      request_.number(1, 1, 2).number(0, 1, 2);  // first echo
      request_.number(0, 1).number(1, 1);        // no remission, ranges of 16 bits
      request_.number(0, 1);                     // its unit
      request_.number(0, 1, 2).number(0, 1, 2);  // no encoders
      request_.number(0, 1).number(0, 1).number(0, 1).number(0, 1);
      request_.number(static_cast<std::uint32_t>(params().skip + 1), 2);  // every scan, or one of so many
      break;
    default:
      break;
  }
  send(request_.finish());
}

void BringUp::enter(Step step, std::int64_t now_ns) {
  shape_ = {};
  const std::int64_t patience_ns = step == Step::kSetScan     ? kSetNs
                                   : step == Step::kFirstScan ? kFirstScanNs
                                   : step == Step::kStop      ? 0
                                                              : kAnswerNs;
  wait(step, now_ns + std::max(params().reply_timeout_ns, patience_ns));
  send_request_of(step);
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  if (step() == Step::kStop) {
    dialect_ = dialect_ == Dialect::kAscii ? Dialect::kBinary : Dialect::kAscii;
    if (++silences_ >= kDialects) {
      tell_silence(sink);
    }
  }
  enter(Step::kStop, now_ns);
}

bool BringUp::answers(const Telegram& telegram) const {
  const std::string_view head = head_of(step());
  const bool is_answer = telegram.command().ends_with('A') || telegram.command() == "sAN";
  return !head.empty() && (telegram.is_refusal() || (is_answer && telegram.name() == head.substr(4)));
}

void BringUp::on_telegram(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  dialect_ = telegram.dialect;
  silences_ = 0;
  if (answers(telegram)) {
    on_answer(telegram, now_ns, sink);
  } else if (step() == Step::kFirstScan && telegram.name() == "LMDscandata" && telegram.command() == "sSN") {
    on_scan(telegram, now_ns, sink);
  }
}

void BringUp::on_answer(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  switch (step()) {
    case Step::kStop:
      count_answer(kStopsMax, sink);
      return enter(Step::kLogIn, now_ns);
    case Step::kLogIn:
      return enter(params().sopas_scan == SopasScan::kAsSet ? Step::kSetContent : Step::kAskScan, now_ns);
    case Step::kAskScan:
      return on_scan_settings(telegram, now_ns);
    case Step::kSetScan:
      return on_scan_set(telegram, now_ns, sink);
    case Step::kSetContent:
      on_content_set(telegram, sink);
      return enter(Step::kMeasure, now_ns);
    case Step::kMeasure:
      return enter(Step::kRun, now_ns);
    case Step::kRun:
      return enter(Step::kStart, now_ns);
    case Step::kStart:
      return telegram.is_refusal() ? fail(telegram.refusal_code(), now_ns, sink) : enter(Step::kFirstScan, now_ns);
    case Step::kFirstScan:
    case Step::kPause:
    case Step::kDone:
      return;
  }
}

void BringUp::on_scan_settings(const Telegram& telegram, std::int64_t now_ns) {
  Fields fields = telegram.fields();
  const std::uint32_t rate_chz = fields.number(4);
  static_cast<void>(fields.number(2));
  const std::uint32_t step_tmdeg = fields.number(4);
  const ScanSetting wished = setting_of(params().sopas_scan);
  const bool is_so =
      !telegram.is_refusal() && fields.ok() && rate_chz == wished.rate_chz && step_tmdeg == wished.step_tmdeg;
  enter(is_so ? Step::kSetContent : Step::kSetScan, now_ns);
}

// One that cannot is used as it is: its scans tell how that is.
void BringUp::on_scan_set(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  Fields fields = telegram.fields();
  const auto result = static_cast<int>(fields.number(1));
  if (telegram.is_refusal()) {
    tell_error(telegram.refusal_code(), sink);
  } else if (result != 0) {
    tell_error(kScanRefused + result, sink);
  }
  enter(Step::kSetContent, now_ns);
}

// One that refuses sends every scan, of what content a scan tells.
void BringUp::on_content_set(const Telegram& telegram, LrfSink& sink) {
  scans_per_telegram_ = telegram.is_refusal() ? 1 : params().skip + 1;
  if (telegram.is_refusal() && params().skip > 0) {
    tell_error(telegram.refusal_code(), sink);
  }
}

void BringUp::on_scan(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink) {
  const Result<ScanData> data = stream().read(telegram);
  if (!data.ok()) {
    return data.error() == Errc::kFrameMalformed ? void() : refuse(data.error(), now_ns, sink);
  }
  if (std::exchange(shape_, data.value().shape) != data.value().shape) {
    return;
  }
  if (const Errc error = stream().configure(data.value(), scans_per_telegram_); error != Errc::kOk) {
    return refuse(error, now_ns, sink);
  }
  finish();
}

}  // namespace odoless::sopas
