#include "tools/emulate/sick_device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace odoless {
namespace {

constexpr std::array<SickModel, 4> kModels{{
    {.name = "lms200", .product = "LMS200;30106", .range_far_m = 80.0, .range_sd_m = 0.015, .variant = {18000, 100}},
    {.name = "lms200-half", .product = "LMS200;30106", .range_far_m = 80.0, .range_sd_m = 0.015},
    {.name = "lms291", .product = "LMS291;S05", .range_far_m = 80.0, .range_sd_m = 0.010},
    {.name = "lms291-quarter",
     .product = "LMS291;S05",
     .range_far_m = 80.0,
     .range_sd_m = 0.010,
     .variant = {10000, 25}},
}};

constexpr std::size_t kHead = sick::kHeadBytes;
constexpr std::size_t kSum = sick::kSumBytes;
constexpr std::size_t kConfigurationBytes = 34;
constexpr std::size_t kStateBytes = 151;
constexpr int kStatus = 0x10;                    ///< of this kind of device, without complaint
constexpr std::int64_t kHearsNs = 10'000'000;    ///< before it says that it has heard; the manual allows 60 ms
constexpr std::int64_t kAnswersNs = 30'000'000;  ///< from then on to its answer
constexpr std::int64_t kBootNs = 1'000'000'000;  ///< until it hears again
constexpr int kRequestMode = 0x25;
constexpr int kAck = 0x06;
constexpr int kNak = 0x15;
constexpr std::string_view kPassword = "SICK_LMS";

char byte(int value) { return static_cast<char>(value); }
int number(std::string_view text, std::size_t at) {
  return static_cast<unsigned char>(text[at]) + 256 * static_cast<unsigned char>(text[at + 1]);
}
void put(std::string& text, unsigned value) {
  text += static_cast<char>(value & 0xFFU);
  text += static_cast<char>(value >> 8U);
}

unsigned sum_of(std::string_view bytes) { return sick::checksum(std::as_bytes(std::span(bytes.data(), bytes.size()))); }

/// A command and data behind it.
std::string message(int command, std::string_view data) {
  std::string payload(1, byte(command));
  payload.append(data);
  return payload;
}

/// Command and data with a status without complaint, as a whole telegram.
std::string telegram(std::string_view payload) {
  std::string bytes = message(0x02, "\x80");
  put(bytes, static_cast<unsigned>(payload.size() + 1));
  bytes.append(payload);
  bytes += byte(kStatus);
  put(bytes, sum_of(bytes));
  return bytes;
}

}  // namespace

std::span<const SickModel> sick_models() { return kModels; }

const SickModel* find_sick_model(std::string_view name) {
  const auto* const found =
      std::find_if(kModels.begin(), kModels.end(), [&](const SickModel& m) { return m.name == name; });
  return found == kModels.end() ? nullptr : found;
}

std::vector<EmulatedBeam> sick_beams(const sick::Variant& variant) {
  std::vector<EmulatedBeam> beams;
  for (int i = 0; i < variant.beams(); ++i) {
    const int turn = i % variant.turns();
    const std::int64_t in_turn_ns = sick::kTurnNs * i * variant.step_cdeg / 36000;
    beams.push_back({(i * variant.step_cdeg - variant.field_of_view_cdeg / 2) * std::numbers::pi / 18000.0,
                     turn * sick::kTurnNs + in_turn_ns});
  }
  return beams;
}

SickDevice::SickDevice(const SickModel& model, EmulatedScans& source, EmulatedLrfOptions options)
    : EmulatedLrf(source, std::move(options)),
      model_(model),
      variant_(model.variant),
      configuration_(kConfigurationBytes, '\0') {
  power_up();
}

void SickDevice::power_up() {
  received_.clear();
  installing_ = false;
  output_.reset();
  mode_ = kRequestMode;
  baud_ = 9600;
  next_baud_ = baud_;
  variant_ = model_.variant;
}

void SickDevice::restart(std::int64_t now_ns) {
  forget_later();
  boot(now_ns);
}

void SickDevice::boot(std::int64_t now_ns) {
  power_up();
  const std::string is_on = telegram(message(0x90, model_.product));
  deaf_until_ns_ = now_ns + kBootNs;
  line_free_ns_ = deaf_until_ns_ + static_cast<std::int64_t>(is_on.size()) * 10 * 1'000'000'000 / baud_;
  send_later(is_on, line_free_ns_);
}

std::int64_t SickDevice::transfer_ns() const {
  const std::size_t bytes = output_ ? output_->telegram_bytes() : kHead + variant_.payload_bytes() + kSum;
  return static_cast<std::int64_t>(bytes) * 10 * 1'000'000'000 / baud_;
}

std::int64_t SickDevice::measured_ns(std::int64_t index) const {
  const int turns = output_ ? output_->turns(variant_) : variant_.turns();
  return origin_ns() + source().start_ns(index) + (turns - 1) * sick::kTurnNs +
         sick::kTurnNs * variant_.field_of_view_cdeg / 36000;
}

std::int64_t SickDevice::due_ns(std::int64_t index) const { return measured_ns(index) + transfer_ns(); }

void SickDevice::on_due(std::int64_t index) {
  const std::int64_t start_ns = origin_ns() + source().start_ns(index);
  if (!streams() || measured_ns(index) < line_free_ns_ || start_ns < next_start_ns_) {
    return;
  }
  const SickOutput output = *output_;
  next_start_ns_ = start_ns + output.turns(variant_) * sick::kTurnNs - sick::kTurnNs / 2;
  collect(index);
  if (collected_ < output.scans) {
    return;
  }
  line_free_ns_ = due_ns(index);
  const bool is_scan = !output.is_mean() && !output.by_turns;
  send_piece(frame(index), is_scan ? std::optional(SentScan{index, start_ns}) : std::nullopt, due_ns(index));
  collected_ = 0;
  if (std::exchange(is_once_, false)) {
    output_.reset();
  }
}

void SickDevice::collect(std::int64_t index) {
  beams_ = sick_beams(variant_);
  if (output_->by_turns) {
    const std::vector<EmulatedBeam> all = std::exchange(beams_, {});
    for (auto i = static_cast<std::size_t>(part_of(index)); i < all.size();
         i += static_cast<unsigned>(variant_.turns())) {
      beams_.push_back({all[i].angle_rad, all[i].time_ns - part_of(index) * sick::kTurnNs});
    }
  }
  ranges_m_.resize(beams_.size());
  measure(index, beams_, ranges_m_, due_ns(index));
  if (collected_++ == 0) {
    sums_m_.assign(ranges_m_.size(), 0.0);
  }
  for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
    const double far_m = std::numeric_limits<double>::infinity();  // a mean with what is too far is too far
    sums_m_[i] += ranges_m_[i] >= model_.range_far_m ? far_m : ranges_m_[i];
  }
}

unsigned SickDevice::value(double range_m) const {
  const unsigned codes = in_mm() ? 0x7FF7 : 0x1FF7;
  const double counted = std::round(range_m * (in_mm() ? 1000.0 : 100.0));
  return range_m >= model_.range_far_m || counted >= codes ? codes : static_cast<unsigned>(counted);
}

std::string SickDevice::frame(std::int64_t index) const {
  const SickOutput& output = *output_;
  const auto first = static_cast<std::size_t>(output.first - 1);
  const std::size_t last = output.by_turns ? sums_m_.size() : static_cast<std::size_t>(output.last);
  const std::size_t wished = last - first;
  const std::size_t sent = fault(FaultKind::kBeams, due_ns(index)) ? wished * 2 / 3 : wished;
  const bool is_part = output.is_part();
  constexpr unsigned kPartOfScan = 0x2000;
  const unsigned part = output.by_turns && variant_.turns() > 1
                            ? kPartOfScan | static_cast<unsigned>(part_of(index) * 4 / variant_.turns()) << 11U
                            : 0U;
  std::string payload = message(output.answer, {});
  if (output.is_mean()) {
    payload += byte(output.scans);
  }
  if (is_part) {
    put(payload, static_cast<unsigned>(output.first));
    put(payload, static_cast<unsigned>(output.last));
  }
  put(payload, static_cast<unsigned>(sent) | part | (in_mm() ? 0x4000U : 0U));
  for (std::size_t i = first; i < first + sent; ++i) {
    put(payload, value(sums_m_[i] / output.scans));
  }
  return telegram(payload);
}

void SickDevice::hear(std::string_view bytes, std::int64_t now_ns) {
  if (now_ns < deaf_until_ns_) {
    return;
  }
  received_ += bytes;
  while (take_request(now_ns)) {
  }
}

/// Whether there was a request, or what is none has been thrown away.
bool SickDevice::take_request(std::int64_t now_ns) {
  if (received_.empty()) {
    return false;
  }
  if (received_[0] != '\x02' || (received_.size() > 1 && received_[1] != '\0')) {
    received_.erase(0, 1);
    return true;
  }
  if (received_.size() < kHead) {
    return false;
  }
  const std::size_t summed = kHead + static_cast<std::size_t>(number(received_, 2));
  if (summed > 100) {
    received_.erase(0, 1);
    return true;
  }
  if (received_.size() < summed + kSum) {
    return false;
  }
  const std::string request = received_.substr(0, summed);
  const bool is_right = static_cast<unsigned>(number(received_, summed)) == sum_of(request) && summed > kHead;
  received_.erase(0, is_right ? summed + kSum : 1);
  if (is_right) {
    execute(std::string_view(request).substr(kHead), now_ns);
  } else {
    send(message(kNak, {}), now_ns);
  }
  return true;
}

void SickDevice::execute(std::string_view payload, std::int64_t now_ns) {
  const std::int64_t byte_ns = 10 * 1'000'000'000LL / baud_;
  const std::optional<std::string> answer = answer_to(payload, now_ns);
  const std::int64_t heard_ns = std::max(now_ns + kHearsNs, line_free_ns_) + byte_ns;
  line_free_ns_ = heard_ns;
  send_later(message(kAck, {}), heard_ns);
  if (answer) {
    const std::string bytes = telegram(*answer);
    line_free_ns_ = heard_ns + kAnswersNs + static_cast<std::int64_t>(bytes.size()) * byte_ns;
    send_later(bytes, line_free_ns_);
  }
  baud_ = next_baud_;
  if (std::exchange(resets_, false)) {
    boot(line_free_ns_);
  }
}

std::optional<std::string> SickDevice::answer_to(std::string_view payload, std::int64_t now_ns) {
  switch (static_cast<unsigned char>(payload[0])) {
    case 0x10:
      resets_ = true;
      return message(0x91, {});
    case 0x20:
      return set_mode(payload, now_ns);
    case 0x31:
      return state();
    case 0x3A:
      return message(0xBA, model_.product);
    case 0x3B:
      return set_variant(payload);
    case 0x74:
      return message(0xF4, configuration_);
    case 0x77:
      return set_configuration(payload);
    default:
      return request_once(payload, now_ns);
  }
}

// It sends nothing by itself then, and a scan when it is asked for one.
std::optional<std::string> SickDevice::request_once(std::string_view payload, std::int64_t now_ns) {
  const std::optional<SickOutput> wished =
      sick_requested(static_cast<unsigned char>(payload[0]), payload.substr(1), variant_);
  if (!wished || mode_ != kRequestMode || streams()) {
    return message(0x92, {});
  }
  output_ = wished;
  is_once_ = true;
  collected_ = 0;
  start_source(now_ns);
  return std::nullopt;
}

std::string SickDevice::set_mode(std::string_view payload, std::int64_t now_ns) {
  const int mode = payload.size() < 2 ? -1 : static_cast<unsigned char>(payload[1]);
  const auto result = [](int code) { return message(0xA0, std::string(1, byte(code))); };
  switch (mode) {
    case 0x00:
      installing_ = payload.substr(2) == kPassword;
      if (installing_) {
        mode_ = mode;
        output_.reset();
      }
      return result(installing_ ? 0 : 1);
    case kRequestMode:
      installing_ = false;
      mode_ = mode;
      output_.reset();
      return result(0);
    case 0x40:
      next_baud_ = 38400;
      return result(0);
    case 0x41:
      next_baud_ = 19200;
      return result(0);
    case 0x42:
      next_baud_ = 9600;
      return result(0);
    case 0x48:
      next_baud_ = 500000;
      return result(0);
    default:
      return stream(mode, payload.substr(std::min<std::size_t>(2, payload.size())), now_ns) ? result(0) : result(2);
  }
}

bool SickDevice::stream(int mode, std::string_view parameters, std::int64_t now_ns) {
  const std::optional<SickOutput> wished = sick_streamed(mode, parameters, variant_);
  if (!wished) {
    return false;
  }
  installing_ = is_once_ = false;
  mode_ = mode;
  output_ = wished;
  collected_ = 0;
  start_source(now_ns);
  return true;
}

std::string SickDevice::set_variant(std::string_view payload) {
  if (payload.size() != 5) {
    return message(0x92, {});
  }
  const sick::Variant wished{number(payload, 1) * 100, number(payload, 3)};
  const bool step_is_known = wished.step_cdeg == 100 || wished.step_cdeg == 50 ||
                             (wished.step_cdeg == 25 && wished.field_of_view_cdeg == 10000);
  const bool is_known =
      step_is_known && (wished.field_of_view_cdeg == 18000 || wished.field_of_view_cdeg == 10000) && !streams();
  variant_ = is_known ? wished : variant_;
  std::string answer = message(0xBB, std::string(1, byte(is_known ? 1 : 0)));
  answer.append(payload.substr(1));
  return answer;
}

std::string SickDevice::set_configuration(std::string_view payload) {
  const bool is_accepted = installing_ && payload.size() == 1 + kConfigurationBytes;
  if (is_accepted) {
    configuration_ = payload.substr(1);
    ++writes_;
  }
  std::string answer = message(0xF7, std::string(1, byte(is_accepted ? 1 : 0)));
  answer.append(configuration_);
  return answer;
}

std::string SickDevice::state() const {
  std::string state(kStateBytes, '\0');
  state[0] = '\xB1';
  std::copy_n("V02.30 ", 7, state.begin() + 1);
  state[8] = byte(mode_);
  state[102] = configuration_[5];
  state[107] = byte(variant_.field_of_view_cdeg / 100);
  state[109] = byte(variant_.step_cdeg);
  state[122] = configuration_[6];
  return state;
}

}  // namespace odoless
