#include "tools/log/message_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/float_precision.hpp"
#include "tools/command/error.hpp"
#include "tools/log/fields.hpp"
#include "tools/log/formats/formats.hpp"
#include "tools/log/printable.hpp"
#include "tools/log/stamp.hpp"

namespace odoless {
namespace {

constexpr std::size_t kTopicsMax = 10'000;

constexpr std::array<MessageFormat, 5> kFormats{{
    {"LCM log", is_lcm_log, open_lcm_log},
    {"ROS 1 bag", is_ros_bag, open_ros_bag},
    {"MCAP", is_mcap, open_mcap},
    {"ROS 2 bag (SQLite)", is_sqlite_bag, open_sqlite_bag},
    {"MRPT rawlog", is_rawlog, open_rawlog},
}};

std::string list_of(const std::vector<LogTopic>& topics, bool with_scans) {
  std::string list;
  for (const LogTopic& topic : topics) {
    if (topic.messages > 0 && (topic.has_scans || !with_scans)) {
      list += fmt::format("{}{} ({}, {} messages)", list.empty() ? "" : ", ", topic.name, topic.type, topic.messages);
    }
  }
  return list.empty() ? "none" : list;
}

/// Gathers the scans of one topic.
class Gathering {
 public:
  Gathering(MessageLog& log, const LogChoice& choice) : log_(log), choice_(choice) {}

  void add() {
    const LogTopic& topic = log_.topics()[log_.topic()];
    if (!topic.has_scans || (!choice_.topic.empty() && choice_.topic != topic.name)) {
      return;
    }
    topic_ = scans_.empty() ? log_.topic() : topic_;
    is_ambiguous_ = is_ambiguous_ || topic_ != log_.topic();
    if (!is_ambiguous_) {
      keep(log_.scan());
    }
  }

  ScanLog finish() {
    check();
    std::vector<std::int64_t> stamps_ns;
    for (const LogScan& scan : scans_) {
      stamps_ns.push_back(scan.stamp_ns);
    }
    ScanLog result{.format = fmt::format("{}, {}", log_.format(), log_.topics()[topic_].name),
                   .has_stamps = stamps_are_usable(stamps_ns),
                   .scans = std::move(scans_)};
    for (std::size_t i = 0; !result.has_stamps && i < result.scans.size(); ++i) {
      result.scans[i].stamp_ns = static_cast<std::int64_t>(i) * choice_.default_period_ns;
    }
    if (const std::string passed_over = log_.passed_over(); !passed_over.empty()) {
      result.passed_over.push_back(passed_over);
    }
    return result;
  }

 private:
  void check() const {
    if (is_ambiguous_) {
      throw DataError(log_.name(), 0, "several topics have scans",
                      "--topic with one of " + list_of(log_.topics(), true));
    }
    if (scans_.empty() && !choice_.topic.empty()) {
      throw DataError(log_.name(), 0, fmt::format("there are no scans of topic {}", choice_.topic),
                      "one of these topics with scans: " + list_of(log_.topics(), true));
    }
    if (scans_.empty()) {
      const std::string advice = log_.advice();
      throw DataError(
          log_.name(), 0, fmt::format("this {} has no scans", log_.format()),
          advice.empty() ? fmt::format("{}; its topics: {}", kScanTypes, list_of(log_.topics(), false)) : advice);
    }
  }

  void keep(LogScan scan) {
    kept_bytes_ += sizeof(LogScan) + sizeof(float) * scan.ranges_m.size();
    if (kept_bytes_ > LineReader::kKeptBytesMax) {
      throw DataError(log_.name(), 0,
                      fmt::format("its scans take more than {} MiB of memory", LineReader::kKeptBytesMax >> 20U),
                      "a shorter log, such as a part of this one");
    }
    scans_.push_back(std::move(scan));
  }

  MessageLog& log_;
  const LogChoice& choice_;
  std::vector<LogScan> scans_;
  std::size_t topic_ = 0;
  bool is_ambiguous_ = false;
  std::size_t kept_bytes_ = 0;
};

/// What is wrong with a scan as a whole; empty: nothing.
std::string wrong_with(const LogScan& scan) {
  if (scan.ranges_m.empty()) {
    return "it has no ranges";
  }
  if (scan.ranges_m.size() > Fields::kRangesMax) {
    return fmt::format("it has {} ranges, more than {}", scan.ranges_m.size(), Fields::kRangesMax);
  }
  if (!std::isfinite(scan.start_angle_rad) || !std::isfinite(scan.angle_step_rad) || scan.angle_step_rad == 0.0) {
    return fmt::format("its ranges begin at {} rad, {} rad apart", scan.start_angle_rad, scan.angle_step_rad);
  }
  return "";
}

}  // namespace

bool MessageLog::next() {
  Head head;
  if (!read(head)) {
    return false;
  }
  topic_ = head.topic;
  LogTopic& topic = topics_[topic_];
  topic.first_ns = topic.messages == 0 ? head.recorded_ns : std::min(topic.first_ns, head.recorded_ns);
  topic.last_ns = topic.messages == 0 ? head.recorded_ns : std::max(topic.last_ns, head.recorded_ns);
  ++topic.messages;
  return true;
}

LogScan MessageLog::scan() {
  DecodedScan decoded = decode();
  auto* const scan = std::get_if<LogScan>(&decoded);
  if (scan != nullptr) {
    scan->stamp_ns = to_message_precision(scan->stamp_ns);
    scan->start_angle_rad = to_float_precision(scan->start_angle_rad);
    scan->angle_step_rad = to_float_precision(scan->angle_step_rad);
  }
  const std::string wrong = scan != nullptr ? wrong_with(*scan) : std::get<std::string>(decoded);
  if (!wrong.empty()) {
    const LogTopic& topic = topics_[topic_];
    throw DataError(name_, 0, fmt::format("message {} of {}: {}", topic.messages, topic.name, wrong),
                    fmt::format("a whole {}", topic.type));
  }
  return std::move(*scan);
}

std::size_t MessageLog::topic_of(std::string_view any_name, std::string_view any_type, bool has_scans) {
  const std::string name = printable(any_name);
  const std::string type = printable(any_type);
  const auto found = std::find_if(topics_.begin(), topics_.end(),
                                  [&](const LogTopic& topic) { return topic.name == name && topic.type == type; });
  if (found != topics_.end()) {
    return static_cast<std::size_t>(found - topics_.begin());
  }
  if (topics_.size() == kTopicsMax) {
    throw DataError(name_, 0, fmt::format("there are more than {} topics", kTopicsMax), "fewer");
  }
  topics_.push_back({.name = name, .type = type, .has_scans = has_scans});
  return topics_.size() - 1;
}

const MessageFormat* find_message_format(std::string_view head) {
  const auto* const found =
      std::find_if(kFormats.begin(), kFormats.end(), [&](const MessageFormat& format) { return format.is_one(head); });
  return found == kFormats.end() ? nullptr : found;
}

ScanLog read_scans(MessageLog& log, const LogChoice& choice) {
  Gathering gathering(log, choice);
  while (log.next()) {
    gathering.add();
  }
  return gathering.finish();
}

}  // namespace odoless
