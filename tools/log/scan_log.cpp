#include "tools/log/scan_log.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "tools/command/error.hpp"
#include "tools/log/message_log.hpp"
#include "tools/log/scan_lines.hpp"
#include "tools/log/stamp.hpp"

namespace odoless {
namespace {

constexpr const char* kKnownScans =
    "CARMEN FLASER or ROBOTLASER1, DP-SLAM Laser, or CSV t,angle_min,angle_inc,time_inc,scan_time,rmin,rmax,n,ranges";

/// Grows a log line by line; the first scan decides the format.
class LogBuilder {
 public:
  void add(std::string_view line, LineReader& lines) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (format_ == nullptr) {
      format_ = find_scan_format(line);
    }
    if (format_ != nullptr && format_->is_scan(line)) {
      add_scan(line, lines);
    } else if (format_ != nullptr && !format_->may_skip(line)) {
      throw DataError(lines.name(), lines.number(), "the line is no scan", fmt::format("a line of {}", format_->name));
    }
  }

  ScanLog finish(const std::string& name, std::int64_t default_period_ns) {
    if (format_ == nullptr) {
      throw DataError(name, 0, "there are no scans", kKnownScans);
    }
    log_.format = format_->name;
    log_.has_stamps = has_stamps_ && stamps_are_usable(stamps_ns_);
    for (std::size_t i = 0; !log_.has_stamps && i < log_.scans.size(); ++i) {
      log_.scans[i].stamp_ns = static_cast<std::int64_t>(i) * default_period_ns;
    }
    return std::move(log_);
  }

 private:
  void add_scan(std::string_view line, LineReader& lines) {
    fields_.split(line, lines, format_->separator);
    LineScan parsed = log_.scans.empty() ? parse_first() : format_->parse(fields_);
    if (!log_.scans.empty() && parsed.has_stamp != has_stamps_) {
      fields_.fail(parsed.has_stamp ? "only this scan has a time stamp" : "this scan alone has no time stamp",
                   "stamps in all scans or in none");
    }
    has_stamps_ = parsed.has_stamp;
    lines.keep(sizeof(LogScan) + sizeof(float) * parsed.scan.ranges_m.size());
    stamps_ns_.push_back(parsed.scan.stamp_ns);
    log_.scans.push_back(std::move(parsed.scan));
  }

  // Of seconds since 1970 a nanosecond count has 19 digits: what has more is of a smaller unit.
  LineScan parse_first() {
    for (const int digits : {6, 3, 0}) {
      try {
        return format_->parse(fields_);
      } catch (const DataError&) {
        fields_.set_stamp_digits(digits);
        log_.stamp_digits = digits;
      }
    }
    return format_->parse(fields_);
  }

  const ScanFormat* format_ = nullptr;
  bool has_stamps_ = false;
  std::vector<std::int64_t> stamps_ns_;
  Fields fields_;
  ScanLog log_;
};

}  // namespace

ScanLog read_scan_log(LineReader& lines, std::int64_t default_period_ns) {
  LogBuilder builder;
  std::string_view line;
  while (lines.next(line)) {
    builder.add(line, lines);
  }
  return builder.finish(lines.name(), default_period_ns);
}

ScanLog read_scan_log(const std::filesystem::path& path, const LogChoice& choice) {
  auto bytes = std::make_unique<PeekedStream>(open_bytes(path));
  if (const MessageFormat* const format = find_message_format(bytes->head()); format != nullptr) {
    return read_scans(*format->open(std::move(bytes), path), choice);
  }
  if (!choice.topic.empty()) {
    throw UsageError(fmt::format("--topic {}: {} has no topics", choice.topic, path.string()));
  }
  LineReader lines(std::move(bytes), path.string());
  return read_scan_log(lines, choice.default_period_ns);
}

std::vector<LogTopic> read_topics(const std::filesystem::path& path) {
  auto bytes = std::make_unique<PeekedStream>(open_bytes(path));
  const MessageFormat* const format = find_message_format(bytes->head());
  if (format == nullptr) {
    return {};
  }
  const std::unique_ptr<MessageLog> log = format->open(std::move(bytes), path);
  while (log->next()) {
  }
  return log->topics();
}

}  // namespace odoless
