#include "tools/log/plausibility.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "tools/command/error.hpp"
#include "tools/log/straightness.hpp"

namespace odoless {
namespace {

constexpr double kDegreeRad = std::numbers::pi / 180.0;
constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr std::size_t kScans_min = 8;  // with fewer nothing is said of stamps

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double seconds_between(const LogScan& from, const LogScan& to) {
  return 1e-9 * (static_cast<double>(to.stamp_ns) - static_cast<double>(from.stamp_ns));
}

// Over many scans, so that bursts and late stamps do not count.
double usual_period_s(const ScanLog& log) {
  const std::size_t span = std::min<std::size_t>(32, log.scans.size() / 2);
  std::vector<double> periods_s;
  for (std::size_t i = span; i < log.scans.size(); ++i) {
    periods_s.push_back(seconds_between(log.scans[i - span], log.scans[i]) / static_cast<double>(span));
  }
  return median(periods_s);
}

struct Unit {
  double factor;
  const char* told;
};

std::string share_text(std::size_t part, std::size_t all) { return fmt::format("{} of {}", part, all); }

/// Stamps that are of another unit than seconds.
void correct_unit_of_stamps(ScanLog& log, Plausibility& out) {
  constexpr double kPeriod_min_s = 0.004;
  constexpr double kPeriod_max_s = 10.0;
  constexpr double kPeriod_sure_s = 20.0;  // in milliseconds: up to here it may be a laser that takes key scans
  constexpr std::array<Unit, 4> kUnits{
      {{1e-3, "in milliseconds"}, {1e-6, "in microseconds"}, {1e-9, "in nanoseconds"}, {1e3, "divided by 1000"}}};
  const double period_s = usual_period_s(log);
  if (period_s >= kPeriod_min_s && period_s <= kPeriod_max_s) {
    return;
  }
  for (const Unit& unit : kUnits) {
    const double right_s = period_s * unit.factor;
    if (right_s < kPeriod_min_s || right_s > 5.0 || (period_s > kPeriod_max_s && period_s < kPeriod_sure_s)) {
      continue;
    }
    for (LogScan& scan : log.scans) {
      const double right_ns = static_cast<double>(scan.stamp_ns) * unit.factor;
      scan.stamp_ns = unit.factor < 1.0
                          ? scan.stamp_ns / std::llround(1.0 / unit.factor)
                          : (std::abs(right_ns) < 9e18 ? scan.stamp_ns * std::llround(unit.factor) : scan.stamp_ns);
      scan.stamp_ns -= scan.stamp_ns % 1000;
    }
    out.corrected.push_back(
        fmt::format("the stamps are {}: {:.3g} s from scan to scan, taken as {:.3f} s", unit.told, period_s, right_s));
    return;
  }
  out.wrong = fmt::format("the stamps are {:.3g} s apart from scan to scan", period_s);
  out.right = "stamps in seconds, of a laser with 0.2 to 200 scans a second; DP-SLAM's format has no stamps";
}

/// How much scans differ on average from the ones before, in an order; at most so many of them are looked at.
double roughness_m(const ScanLog& log, const std::vector<std::size_t>& order, const std::vector<std::size_t>& places) {
  constexpr std::size_t kPlaces_max = 4000;
  constexpr float kFar_m = 1.0F;
  const std::size_t step = places.size() / kPlaces_max + 1;
  double sum_m = 0.0;
  std::size_t beams = 0;
  for (std::size_t k = 0; k < places.size(); k += step) {
    const LogScan& a = log.scans[order[places[k] - 1]];
    const LogScan& b = log.scans[order[places[k]]];
    for (std::size_t beam = 0; beam < std::min(a.ranges_m.size(), b.ranges_m.size()); ++beam) {
      const float difference_m = std::abs(a.ranges_m[beam] - b.ranges_m[beam]);
      if (difference_m >= 0.0F) {  // false for NaN
        sum_m += std::min(difference_m, kFar_m);
        ++beams;
      }
    }
  }
  return beams > 0 ? sum_m / static_cast<double>(beams) : 0.0;
}

/// The order of the stamps against that of the file: where scans change less from one to the next, that is right.
void correct_order(ScanLog& log, Plausibility& out) {
  constexpr double kClearly = 0.8;
  constexpr double kBackwards = 0.9;
  constexpr double kOut_of_order_max = 0.25;
  const std::size_t steps = log.scans.size() - 1;
  std::vector<std::size_t> file(log.scans.size());
  std::iota(file.begin(), file.end(), std::size_t{0});
  std::size_t back = 0;
  for (std::size_t i = 1; i < file.size(); ++i) {
    back += log.scans[i].stamp_ns < log.scans[i - 1].stamp_ns ? 1 : 0;
  }
  if (back == 0) {
    return;
  }
  if (static_cast<double>(back) > kBackwards * static_cast<double>(steps)) {
    out.wrong =
        fmt::format("the stamps are out of order: {} scans are older than the one before", share_text(back, steps));
    out.right = "scans in the order in which they were taken; `tac` turns a file about";
    return;
  }
  std::vector<std::size_t> told = file;
  std::stable_sort(told.begin(), told.end(),
                   [&](std::size_t a, std::size_t b) { return log.scans[a].stamp_ns < log.scans[b].stamp_ns; });
  std::vector<std::size_t> places;
  for (std::size_t i = 1; i < file.size(); ++i) {
    if (told[i] != i || told[i - 1] != i - 1) {
      places.push_back(i);
    }
  }
  const double file_m = roughness_m(log, file, places);
  const double told_m = roughness_m(log, told, places);
  if (told_m < kClearly * file_m) {
    std::vector<LogScan> sorted;
    for (const std::size_t index : told) {
      sorted.push_back(std::move(log.scans[index]));
    }
    log.scans = std::move(sorted);
    out.corrected.push_back(
        fmt::format("{} scans are not in the order of their stamps, which their ranges agree with: "
                    "they were put in it",
                    back));
  } else if (static_cast<double>(back) > kOut_of_order_max * static_cast<double>(steps)) {
    out.wrong = fmt::format(
        "the stamps cannot be of these scans: {} are older than the one before, and the scans' "
        "ranges are in order as they are",
        share_text(back, steps));
    out.right = "a stamp of when each scan was taken";
  }
}

/// Ranges that are returns by their size, at most a million of the log.
std::vector<double> told_returns(const ScanLog& log) {
  const std::size_t step = log.scans.size() * log.scans.front().ranges_m.size() / 1'000'000 + 1;
  std::vector<double> told;
  for (std::size_t i = 0; i < log.scans.size(); i += step) {
    for (const float range_m : log.scans[i].ranges_m) {
      if (std::isfinite(range_m) && range_m > 0.0F) {
        told.push_back(range_m);
      }
    }
  }
  return told;
}

void correct_ranges(ScanLog& log, Plausibility& out) {
  constexpr double kMedian_max_m = 100.0;
  constexpr double kMedian_min_m = 0.05;
  constexpr double kMillimetres_min = 1500.0;  // as centimetres 15 m: too much for most ranges of a scan
  constexpr double kMillimetres_max = 50'000.0;
  constexpr float kRange_m = 300.0F;
  std::vector<double> told = told_returns(log);
  if (told.empty()) {
    out.wrong = "no range is above 0";
    out.right = "ranges in metres";
    return;
  }
  const double middle = median(told);
  if (middle >= kMedian_min_m && middle <= kMedian_max_m) {
    return;
  }
  if (middle < kMillimetres_min || middle > kMillimetres_max) {
    out.wrong = fmt::format("half of the ranges are {} {:.3g}", middle < kMedian_min_m ? "below" : "above", middle);
    out.right = "ranges in metres";
    return;
  }
  for (LogScan& scan : log.scans) {
    scan.no_return_m *= scan.no_return_m > kRange_m ? 1e-3F : 1.0F;
    for (float& range_m : scan.ranges_m) {
      range_m *= 1e-3F;
    }
  }
  out.corrected.push_back(fmt::format("the ranges are in millimetres: half are above {:.0f}", middle));
}

double span_rad(const LogScan& scan) {
  return std::abs(scan.angle_step_rad) * static_cast<double>(scan.ranges_m.size() - 1);
}

void correct_angles(ScanLog& log, Plausibility& out) {
  constexpr double kMore = 1.001;
  constexpr double kField_min_deg = 20.0;  // of a laser
  const auto is_turn = [](const LogScan& scan, double unit) {
    return unit * span_rad(scan) <= kMore * kTurnRad && unit * std::abs(scan.start_angle_rad) <= kMore * kTurnRad;
  };
  const auto wide =
      std::find_if(log.scans.begin(), log.scans.end(), [&](const auto& scan) { return !is_turn(scan, 1.0); });
  if (wide == log.scans.end()) {
    return;
  }
  const bool all_in_deg = std::all_of(log.scans.begin(), log.scans.end(), [&](const auto& scan) {
    return is_turn(scan, kDegreeRad) && span_rad(scan) > kField_min_deg;
  });
  if (!all_in_deg) {
    out.wrong =
        fmt::format("scan {}: {} beams {:.4g} rad apart, from {:.4g} rad on, reach over more than a turn",
                    wide - log.scans.begin(), wide->ranges_m.size(), wide->angle_step_rad, wide->start_angle_rad);
    out.right = "angles in radians within one turn; perhaps the step is told too large, or only one angle in degrees";
    return;
  }
  for (LogScan& scan : log.scans) {
    scan.start_angle_rad = static_cast<float>(scan.start_angle_rad * kDegreeRad);
    scan.angle_step_rad = static_cast<float>(scan.angle_step_rad * kDegreeRad);
  }
  out.corrected.push_back(fmt::format("the angles are in degrees: the beams would reach over {:.0f} turns",
                                      span_rad(log.scans.front()) / kDegreeRad / kTurnRad));
}

/// Walls are straight with the true angle step alone.
void check_step(ScanLog& log, Plausibility& out) {
  const double factor = straight_step_factor(log);
  if (factor != 1.0) {
    const double step_deg = log.scans.front().angle_step_rad / kDegreeRad;
    out.wrong = fmt::format("the beams are told to be {:.3f} deg apart, and walls are bent", step_deg);
    out.right = fmt::format(
        "about {:.3f} deg, with which walls are straight; FLASER without angles has 180 deg, CSV and "
        "ROBOTLASER1 tell their angles",
        factor * step_deg);
  }
}

}  // namespace

Plausibility make_plausible(ScanLog& log) {
  Plausibility out;
  out.corrected = log.passed_over;
  if (log.stamp_digits < 9) {
    const char* const unit = log.stamp_digits == 6   ? "milliseconds"
                             : log.stamp_digits == 3 ? "microseconds"
                                                     : "nanoseconds";
    out.corrected.push_back(fmt::format("the stamps are in {}: in seconds they would be beyond 292 years", unit));
  }
  const std::array<void (*)(ScanLog&, Plausibility&), 3> kAlways{correct_angles, correct_ranges, check_step};
  for (const auto check : kAlways) {
    if (out.is_plausible()) {
      check(log, out);
    }
  }
  if (!log.has_stamps || log.scans.size() < kScans_min) {
    return out;
  }
  if (out.is_plausible()) {
    correct_order(log, out);
  }
  if (out.is_plausible()) {
    correct_unit_of_stamps(log, out);
  }
  return out;
}

ScanLog read_plausible_log(const std::filesystem::path& path, const LogChoice& choice,
                           std::vector<std::string>& corrected) {
  ScanLog log = read_scan_log(path, choice);
  const Plausibility plausibility = make_plausible(log);
  if (!plausibility.is_plausible()) {
    throw DataError(path.string(), 0, plausibility.wrong, plausibility.right);
  }
  corrected = plausibility.corrected;
  return log;
}

}  // namespace odoless
