#include "tools/emulate/sopas_device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "drivers/lrf/sopas/scan_stream.hpp"
#include "tools/emulate/sopas_writer.hpp"

namespace odoless {
namespace {

using sopas::Dialect;

constexpr std::array<SopasModel, 4> kModels{{
    {.name = "lms111",
     .product = "SICK LMS111",
     .ident = "LMS11x_FieldEval V1.36",
     .dialect = Dialect::kAscii,
     .scan_ns = 20'000'000,
     .steps_per_deg = 2,
     .has_settings = true,
     .needs_login = true,
     .is_stamped_at_end = false,
     .range_far_m = 20.0,
     .range_sd_m = 0.012},
    {.name = "tim551",
     .product = "SICK TiM551",
     .ident = "TiM551 V2.54",
     .dialect = Dialect::kAscii,
     .scan_ns = 66'666'667,
     .steps_per_deg = 1,
     .has_settings = false,
     .needs_login = false,
     .is_stamped_at_end = true,
     .range_far_m = 10.0,
     .range_sd_m = 0.02},
    {.name = "tim571",
     .product = "SICK TiM571",
     .ident = "TiM571 V3.02",
     .dialect = Dialect::kBinary,
     .scan_ns = 66'666'667,
     .steps_per_deg = 3,
     .has_settings = false,
     .needs_login = true,
     .is_stamped_at_end = true,
     .range_far_m = 25.0,
     .range_sd_m = 0.02},
    {.name = "lms4124",
     .product = "SICK LMS4124",
     .ident = "LMS4124R V1.20",
     .dialect = Dialect::kBinary,
     .scan_ns = 1'666'667,
     .steps_per_deg = 12,
     .first_tmdeg = 550'000,
     .last_tmdeg = 1'250'000,
     .scans_per_turn = 3,
     .mm_per_count = 0.1,
     .has_settings = false,
     .needs_login = true,
     .is_stamped_at_end = false,
     .range_near_m = 0.7,
     .range_far_m = 3.0,
     .range_sd_m = 0.001},
}};

// Codes of refusals.
constexpr int kMethodDenied = 1;
constexpr int kMethodUnknown = 2;
constexpr int kVariableUnknown = 3;
constexpr int kOutOfLimits = 4;
constexpr int kTooShort = 8;
constexpr int kWriteDenied = 10;
constexpr int kCommandUnknown = 12;
constexpr int kEventUnknown = 15;

constexpr double kFrontDeg = 90.0;
constexpr std::int64_t kThinksNs = 2'000'000;  ///< from the last beam to the first byte
constexpr std::uint32_t kClientPassword = 0xF4724744;
constexpr std::uint32_t kMaintenancePassword = 0xB21ACE26;
constexpr unsigned kRemission = 200;

}  // namespace

std::span<const SopasModel> sopas_models() { return kModels; }

const SopasModel* find_sopas_model(std::string_view name) {
  const auto* const found =
      std::find_if(kModels.begin(), kModels.end(), [&](const SopasModel& m) { return m.name == name; });
  return found == kModels.end() ? nullptr : found;
}

SopasDevice::SopasDevice(const SopasModel& model, EmulatedScans& source, EmulatedLrfOptions options,
                         std::int64_t now_ns)
    : EmulatedLrf(source, options),
      model_(model),
      settings_(settings_at_power_up()),
      clock_host_ns_(now_ns),
      clock_device_ns_(options.counter_start_ms * 1e6) {}

void SopasDevice::restart(std::int64_t now_ns) {
  settings_ = settings_at_power_up();
  is_logged_in_ = is_streaming_ = false;
  reader_.clear();
  clock_host_ns_ = now_ns;
  clock_device_ns_ = 0.0;
}

std::uint32_t SopasDevice::clock_us(std::int64_t now_ns) const {
  const double since_ns = static_cast<double>(now_ns - clock_host_ns_) * (1.0 + drift_ppm_ * 1e-6);
  return static_cast<std::uint32_t>(static_cast<std::int64_t>((clock_device_ns_ + since_ns) * 1e-3));
}

void SopasDevice::set_drift(double drift_ppm, std::int64_t now_ns) {
  clock_device_ns_ += static_cast<double>(now_ns - clock_host_ns_) * (1.0 + drift_ppm_ * 1e-6);
  clock_host_ns_ = now_ns;
  drift_ppm_ = drift_ppm;
}

std::int64_t SopasDevice::scan_start_ns(std::int64_t piece) const {
  return source().start_ns(piece * settings_.turns_per_scan);
}

// The zero index is opposite the front, of each face of the mirror.
std::int64_t SopasDevice::since_zero_ns(double sick_deg) const {
  const double zero_deg = kFrontDeg - 180.0 / model_.scans_per_turn;
  return std::llround((sick_deg - zero_deg) / 360.0 * model_.scans_per_turn * static_cast<double>(scan_ns()));
}

std::int64_t SopasDevice::due_ns(std::int64_t piece) const {
  return origin_ns() + scan_start_ns(piece) + since_zero_ns(model_.last_tmdeg * 1e-4) + kThinksNs;
}

void SopasDevice::on_due(std::int64_t piece) {
  if (!is_streaming_ || piece % settings_.scans_per_telegram != 0) {
    return;
  }
  const std::string bytes = scan_telegram("sSN LMDscandata", piece);
  const std::int64_t to_first_ns = since_zero_ns(settings_.start_tmdeg * 1e-4);
  send_piece(bytes, SentScan{piece * settings_.turns_per_scan, origin_ns() + scan_start_ns(piece) + to_first_ns},
             due_ns(piece));
}

std::string SopasDevice::scan_telegram(std::string_view head, std::int64_t piece) {
  const std::int64_t sent_ns = due_ns(piece);
  int count = (settings_.stop_tmdeg - settings_.start_tmdeg) * settings_.steps_per_deg / 10'000 + 1;
  count = fault(FaultKind::kBeams, sent_ns) ? count * 2 / 3 : count;
  beams_.clear();
  for (int i = 0; i < count; ++i) {
    const double sick_deg = settings_.start_tmdeg * 1e-4 + static_cast<double>(i) / settings_.steps_per_deg;
    beams_.push_back({sopas::bearing_rad(sick_deg), since_zero_ns(sick_deg)});
  }
  ranges_m_.resize(beams_.size());
  measure(piece * settings_.turns_per_scan, beams_, ranges_m_, sent_ns);
  const std::int64_t stamped_ns = model_.is_stamped_at_end ? sent_ns - kThinksNs : origin_ns() + scan_start_ns(piece);
  const auto scans = static_cast<std::uint32_t>(piece) & 0xFFFFU;
  SopasWriter telegram(model_.dialect, head);
  telegram.number(1, 2).number(1, 2).number(0x00A1B2C3, 4).number(0, 1).number(0, 1);
  telegram.number(++telegrams_ & 0xFFFFU, 2).number(scans, 2);
  telegram.number(clock_us(stamped_ns), 4).number(clock_us(sent_ns), 4);
  telegram.number(0, 1).number(0, 1).number(7, 1).number(0, 1).number(0, 2);
  telegram.number(static_cast<std::uint32_t>(std::llround(1e11 / static_cast<double>(scan_ns()))), 4);
  const double beams_per_scan = 360.0 * settings_.steps_per_deg / model_.scans_per_turn;
  telegram.number(static_cast<std::uint32_t>(beams_per_scan * 1e7 / static_cast<double>(scan_ns())), 4);
  telegram.number(0, 2).number(settings_.has_remission ? 2 : 1, 2);
  const auto channel = [&](std::string_view name, float scale, const auto& value_of) {
    telegram.word(name).real(scale).real(0.0F).signed_number(settings_.start_tmdeg);
    telegram.number(static_cast<std::uint32_t>(10'000 / settings_.steps_per_deg), 2);
    telegram.number(static_cast<std::uint32_t>(count), 2);
    for (const double range_m : ranges_m_) {
      const bool is_seen = range_m >= model_.range_near_m && range_m < model_.range_far_m;
      telegram.number(value_of(is_seen ? range_m : 0.0), 2);
    }
  };
  channel("DIST1", static_cast<float>(model_.mm_per_count), [&](double range_m) {
    return static_cast<std::uint32_t>(std::lround(range_m * 1000.0 / model_.mm_per_count));
  });
  if (settings_.has_remission) {
    channel("RSSI1", 1.0F, [](double range_m) { return range_m > 0.0 ? kRemission : 0U; });
  }
  for (int nothing = 0; nothing < 6; ++nothing) {  // 8 bit channels, position, name, comment, time of day, event
    telegram.number(0, 2);
  }
  return telegram.finish();
}

void SopasDevice::hear(std::string_view bytes, std::int64_t now_ns) {
  using Outcome = sopas::TelegramReader::Outcome;
  auto rest = std::as_bytes(std::span(bytes.data(), bytes.size()));
  for (Outcome outcome = reader_.take(rest); outcome != Outcome::kMore; outcome = reader_.take(rest)) {
    if (outcome == Outcome::kTelegram && reader_.telegram().dialect == model_.dialect) {
      execute(reader_.telegram(), now_ns);
    }
  }
}

void SopasDevice::refuse(int code, std::int64_t now_ns) {
  send(SopasWriter(model_.dialect, "sFA").number(static_cast<std::uint32_t>(code), 2).finish(), now_ns);
}

void SopasDevice::execute(const sopas::Telegram& telegram, std::int64_t now_ns) {
  const std::string_view name = telegram.name();
  sopas::Fields fields = telegram.fields();
  if (telegram.command() == "sRN") {
    read_variable(name, now_ns);
  } else if (telegram.command() == "sWN") {
    write_variable(name, fields, now_ns);
  } else if (telegram.command() == "sMN") {
    call_method(name, fields, now_ns);
  } else if (telegram.command() != "sEN") {
    refuse(kCommandUnknown, now_ns);
  } else if (name != "LMDscandata") {
    refuse(kEventUnknown, now_ns);
  } else {
    is_streaming_ = fields.number(1) != 0;
    if (is_streaming_) {
      start_source(now_ns);
      skip_to(now_ns);
    }
    send(SopasWriter(model_.dialect, "sEA LMDscandata").number(is_streaming_ ? 1 : 0, 1).finish(), now_ns);
  }
}

void SopasDevice::read_variable(std::string_view name, std::int64_t now_ns) {
  SopasWriter answer(model_.dialect, "sRA " + std::string(name));
  if (name == "DeviceIdent") {
    answer.text(model_.ident.substr(0, model_.ident.find(' '))).text(model_.ident.substr(model_.ident.find(' ') + 1));
  } else if (name == "FirmwareVersion") {
    answer.text(model_.ident.substr(model_.ident.find(' ') + 1));
  } else if (name == "SCdevicestate") {
    answer.number(1, 1);
  } else if (name == "LMPscancfg" && model_.scans_per_turn == 1) {
    answer.number(static_cast<std::uint32_t>(std::llround(1e11 / static_cast<double>(scan_ns()))), 4).number(1, 2);
    answer.number(static_cast<std::uint32_t>(10'000 / settings_.steps_per_deg), 4);
    answer.signed_number(model_.first_tmdeg).signed_number(model_.last_tmdeg);
  } else if (name == "LMPoutputRange") {
    answer.number(1, 2).number(static_cast<std::uint32_t>(10'000 / settings_.steps_per_deg), 4);
    answer.signed_number(settings_.start_tmdeg).signed_number(settings_.stop_tmdeg);
  } else if (name == "LMDscandata") {
    start_source(now_ns);
    send(scan_telegram("sRA LMDscandata", std::max<std::int64_t>(next_piece() - 1, 0)), now_ns);
    return;
  } else {
    return refuse(kVariableUnknown, now_ns);
  }
  send(answer.finish(), now_ns);
}

void SopasDevice::write_variable(std::string_view name, sopas::Fields fields, std::int64_t now_ns) {
  const bool is_content = name == "LMDscandatacfg";
  if (!is_content && name != "LMPoutputRange") {
    return refuse(kVariableUnknown, now_ns);
  }
  if (!is_logged_in_ && (model_.needs_login || !is_content)) {
    return refuse(kWriteDenied, now_ns);
  }
  if (!(is_content ? set_content(fields) : set_part(fields))) {
    return refuse(fields.ok() ? kOutOfLimits : kTooShort, now_ns);
  }
  send(SopasWriter(model_.dialect, "sWA " + std::string(name)).finish(), now_ns);
}

bool SopasDevice::set_content(sopas::Fields& fields) {
  static_cast<void>(fields.number(1));
  static_cast<void>(fields.number(1));
  const bool has_remission = fields.number(1) != 0;
  for (int byte = 0; byte < 8; ++byte) {
    static_cast<void>(fields.number(1));
  }
  const std::uint32_t every = fields.number(2);
  if (!fields.ok() || every == 0) {
    return false;
  }
  settings_.has_remission = has_remission;
  settings_.scans_per_telegram = every;
  return true;
}

bool SopasDevice::set_part(sopas::Fields& fields) {
  static_cast<void>(fields.number(2));
  static_cast<void>(fields.number(4));
  const std::int32_t start_tmdeg = fields.signed_number();
  const std::int32_t stop_tmdeg = fields.signed_number();
  if (!fields.ok() || start_tmdeg < model_.first_tmdeg || stop_tmdeg > model_.last_tmdeg ||
      start_tmdeg + 10'000 > stop_tmdeg) {
    return false;
  }
  settings_.start_tmdeg = start_tmdeg / 10'000 * 10'000;
  settings_.stop_tmdeg = stop_tmdeg / 10'000 * 10'000;
  return true;
}

// 0: done; 1: no such rate; 2: no such step; 3: neither.
int SopasDevice::set_scan(sopas::Fields& fields, std::int64_t now_ns) {
  const std::uint32_t rate_chz = fields.number(4);
  static_cast<void>(fields.number(2));
  const std::uint32_t step_tmdeg = fields.number(4);
  const bool is_rate = rate_chz == 2500 || rate_chz == 5000;
  const bool is_step = step_tmdeg == 2500 || step_tmdeg == 5000;
  if (!is_rate || !is_step) {
    return is_rate ? 2 : is_step ? 1 : 3;
  }
  if (rate_chz == 5000 && step_tmdeg == 2500) {
    return 2;
  }
  settings_.turns_per_scan = rate_chz == 2500 ? 2 : 1;
  settings_.steps_per_deg = 10'000 / static_cast<int>(step_tmdeg);
  skip_to(now_ns);
  return 0;
}

void SopasDevice::call_method(std::string_view name, sopas::Fields fields, std::int64_t now_ns) {
  SopasWriter answer(model_.dialect, "sAN " + std::string(name));
  if (name == "SetAccessMode") {
    static_cast<void>(fields.number(1));
    const std::uint32_t password = fields.number(4);
    is_logged_in_ = fields.ok() && (password == kClientPassword || password == kMaintenancePassword);
    answer.number(is_logged_in_ ? 1 : 0, 1);
  } else if (name == "Run") {
    is_logged_in_ = false;
    answer.number(1, 1);
  } else if (name == "LMCstartmeas" || name == "LMCstopmeas") {
    answer.number(0, 1);
  } else if (name == "mLMPsetscancfg" && model_.has_settings) {
    if (!is_logged_in_) {
      return refuse(kMethodDenied, now_ns);
    }
    answer.number(static_cast<std::uint32_t>(set_scan(fields, now_ns)), 1);
    answer.number(static_cast<std::uint32_t>(std::llround(1e11 / static_cast<double>(scan_ns()))), 4).number(1, 2);
    answer.number(static_cast<std::uint32_t>(10'000 / settings_.steps_per_deg), 4);
    answer.signed_number(model_.first_tmdeg).signed_number(model_.last_tmdeg);
  } else if (name == "mEEwriteall" && is_logged_in_) {
    answer.number(1, 1);
  } else {
    return refuse(name == "mEEwriteall" ? kMethodDenied : kMethodUnknown, now_ns);
  }
  send(answer.finish(), now_ns);
}

}  // namespace odoless
