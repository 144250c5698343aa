// What an emulated laser answers to each command.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "tools/emulate/scip_device.hpp"
#include "tools/emulate/scip_text.hpp"

namespace odoless {
namespace {

using scip::answer;
using scip::key_line;

constexpr std::array<int, 6> kRatesBaud{19200, 57600, 115200, 250000, 500000, 750000};
constexpr std::int64_t kRebootPatienceNs = 1'000'000'000;
constexpr std::int64_t kBootNs = 2'000'000'000;
constexpr const char* kUndefined = "0E";
constexpr const char* kDenied = "10";

}  // namespace

std::string ScipDevice::reply_to(const std::string& line, std::int64_t now_ns) {
  if (in_scip1_) {
    in_scip1_ = line != "SCIP2.0";
    return line + (in_scip1_ ? "\nE\n\n" : "\n0\n\n");
  }
  const std::string command = line.substr(0, line.find(';'));
  if (line.starts_with("TM")) {
    return reply_to_time(line, now_ns);
  }
  const bool is_reset = command == "RS" || command == "RT" || command == "RB";
  if (in_time_mode_ && !model_.is_newer) {
    return answer(line, kUndefined);
  }
  if (const std::optional<std::string> told = told_of_itself(line, now_ns)) {
    return *told;
  }
  if (in_time_mode_ && !is_reset) {
    return answer(line, kDenied);
  }
  if (scip::is_scan_request(line, model_)) {
    return scan_reply(line, now_ns);
  }
  if (command == "RB" && model_.is_newer) {
    return reply_to_reboot(line, now_ns);
  }
  if (command == "BM") {
    return answer(line, std::exchange(laser_on_, true) ? "02" : "00");
  }
  if (command == "QT" || command == "RS" || command == "RT") {
    if (command != "QT") {
      clock_host_ns_ = now_ns;
      clock_device_ns_ = 0.0;
    }
    reset_state(false);
    return answer(line, "00");
  }
  return answer(line, status_of_setting(command));
}

std::optional<std::string> ScipDevice::told_of_itself(const std::string& line, std::int64_t now_ns) const {
  const std::string command = line.substr(0, line.find(';'));
  if (command == "VV") {
    return line + '\n' + version();
  }
  if (command == "PP") {
    return line + '\n' + parameters();
  }
  if (command == "II") {
    return line + '\n' + state(now_ns);
  }
  return std::nullopt;
}

std::string ScipDevice::reply_to_reboot(const std::string& line, std::int64_t now_ns) {
  if (!first_reboot_ns_ || now_ns - *first_reboot_ns_ > kRebootPatienceNs) {
    first_reboot_ns_ = now_ns;
    return answer(line, "01");
  }
  restart(now_ns);
  deaf_until_ns_ = now_ns + kBootNs;
  return answer(line, "00");
}

// By the protocol's paper only a laser in its time mode tells the time; the newer ones do so always, but don't leave a
// stream for that mode.
std::string ScipDevice::reply_to_time(const std::string& line, std::int64_t now_ns) {
  const std::string command = line.substr(0, line.find(';'));
  if (command == "TM0" && model_.is_newer && stream_) {
    return answer(line, kDenied);
  }
  if (command == "TM0") {
    const bool was_in = std::exchange(in_time_mode_, true);
    laser_on_ = false;
    stream_.reset();
    return answer(line, was_in ? "02" : "00");
  }
  if (command == "TM1") {
    return in_time_mode_ || model_.is_newer
               ? line + '\n' + scip::summed("00") + scip::summed(scip::encoded(counter_ms(now_ns), 4)) + '\n'
               : answer(line, "04");
  }
  if (command == "TM2") {
    return answer(line, std::exchange(in_time_mode_, false) ? "00" : "03");
  }
  return answer(line, "01");
}

std::string ScipDevice::status_of_setting(const std::string& line) {
  if (line.starts_with("SS")) {
    const std::optional<int> baud = scip::decimal(line, 2, 6);
    if (!baud || line.size() != 8) {
      return "01";
    }
    if (std::find(kRatesBaud.begin(), kRatesBaud.end(), *baud) == kRatesBaud.end()) {
      return "02";
    }
    return std::exchange(baud_, *baud) == *baud ? "03" : "00";
  }
  if (line.starts_with("CR")) {
    const std::optional<int> step = scip::decimal(line, 2, 2);
    if (!step || line.size() != 4) {
      return "01";
    }
    return *step <= 10 || *step == 99 ? "00" : "02";
  }
  if (line == "HS0" || line == "HS1") {
    return "00";
  }
  return line.starts_with("HS") ? "01" : kUndefined;
}

std::string ScipDevice::version() const {
  return scip::summed("00") + key_line("VEND", "Hokuyo Automatic Co.,Ltd.") +
         key_line("PROD", fmt::format("{}(emulated)", model_.product)) + key_line("FIRM", "1.0.00(odoless)") +
         key_line("PROT", model_.protocol) + key_line("SERI", "H0000001") + '\n';
}

std::string ScipDevice::parameters() const {
  const auto number = [](const char* key, int value) { return key_line(key, std::to_string(value)); };
  return scip::summed("00") + key_line("MODL", fmt::format("{}(Hokuyo Automatic Co.,Ltd.)", model_.product)) +
         number("DMIN", model_.range_min_mm) + number("DMAX", model_.range_max_mm) +
         number("ARES", model_.steps_per_turn) + number("AMIN", model_.first_step) + number("AMAX", model_.last_step) +
         number("AFRT", model_.front_step) + number("SCAN", model_.turns_per_minute) + '\n';
}

std::string ScipDevice::state(std::int64_t now_ns) const {
  return scip::summed("00") + key_line("MODL", fmt::format("{}(Hokuyo Automatic Co.,Ltd.)", model_.product)) +
         key_line("LASR", laser_on_ ? "ON" : "OFF") +
         key_line("SCSP", fmt::format("Initial({}[rpm])<-Default setting", model_.turns_per_minute)) +
         key_line("MESM", laser_on_ ? "000 Measuring" : "000 Idle") + key_line("SBPS", std::to_string(baud_)) +
         key_line("TIME", fmt::format("{:06X}", counter_ms(now_ns))) + key_line("STAT", "Sensor works well.") + '\n';
}

std::string ScipDevice::scan_reply(const std::string& line, std::int64_t now_ns) {
  const scip::ScanRequest request = scip::parse_scan_request(line, model_);
  if (request.status != "00") {
    return answer(line, request.status);
  }
  if (request.is_stream) {
    laser_on_ = true;
    stream_ = request;
    left_ = request.count;
    skipped_ = request.skip;
    start_source(now_ns);
    return answer(line, "00");
  }
  if (!laser_on_) {
    return answer(line, "10");
  }
  start_source(now_ns);
  return frame(request, line + '\n' + scip::summed("00"), std::max<std::int64_t>(next_piece() - 1, 0));
}

}  // namespace odoless
