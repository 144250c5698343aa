#include "tools/fault_campaign/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/eval/report.hpp"
#include "tools/eval/statistics.hpp"

namespace odoless::campaign {
namespace {

constexpr double kPercent = 100.0;

std::string figure_of(bool known, double value) { return known ? fmt::format("{:.1f}", value) : "-"; }

std::string kind_line(std::string_view name, const Tally& tally, bool has_end) {
  const Statistics said = summarise(tally.said_after_s);
  const Statistics recovered = summarise(tally.recovered_after_s);
  const std::string share =
      has_end ? fmt::format("{}/{}", tally.recovered_after_s.size(), tally.runs) : std::string("-");
  return fmt::format(
      "{:12} {:5} {:7} {:8.1f} {:>6} {:>6} {:>9} {:>6} {:>6} {:8.2f} {:7.1f} {:7.1f} {:7.2f} {:8.2f}\n", name,
      tally.runs, tally.silent_failures, tally.silent_max_s, figure_of(said.count > 0, said.median),
      figure_of(said.count > 0, said.max), share, figure_of(has_end && recovered.count > 0, recovered.median),
      figure_of(has_end && recovered.count > 0, recovered.percentile_95), summarise(tally.final_errors_m).median,
      kPercent * tally.share_of(HealthState::kOk), kPercent * tally.share_of(HealthState::kDegraded),
      kPercent * tally.share_of(HealthState::kLost), kPercent * tally.share_right(HealthState::kOk));
}

std::string calibration_text(const Calibration& calibration) {
  std::string text = "calibration: poses said to be right with a probability, and how many were\n";
  for (const Calibration::Bin& bin : calibration.bins) {
    if (bin.poses > 0) {
      text += fmt::format("  said {:5.1f} %  right {:5.1f} %  of {} poses\n", kPercent * bin.said(),
                          kPercent * bin.share_right(), bin.poses);
    }
  }
  return text + fmt::format("  mean difference {:.1f} points\n", kPercent * calibration.error());
}

std::string failure_lines(std::span<const RunResult> runs) {
  std::string text;
  for (const RunResult& run : runs) {
    if (run.verdict.failed_silently()) {
      text += fmt::format("silent failure: {}: OK and wrong for {:.1f} s from {:.1f} s on\n", describe(run.scenario),
                          run.verdict.silent_s, run.verdict.silent_from_s);
    }
  }
  return text;
}

bool has_end(FaultKind kind) {
  return kind != FaultKind::kNone && kind != FaultKind::kMirrored && kind != FaultKind::kWavering;
}

nlohmann::ordered_json json_of(const Statistics& figures) {
  return {{"count", figures.count},
          {"median", figures.median},
          {"percentile_95", figures.percentile_95},
          {"max", figures.max}};
}

nlohmann::ordered_json json_of(const Calibration& calibration) {
  nlohmann::ordered_json bins = nlohmann::ordered_json::array();
  for (const Calibration::Bin& bin : calibration.bins) {
    bins.push_back({{"poses", bin.poses}, {"said", bin.said()}, {"right", bin.share_right()}});
  }
  return {{"mean_difference", calibration.error()}, {"bins", bins}};
}

nlohmann::ordered_json json_of(const Tally& tally) {
  return {{"runs", tally.runs},
          {"silent_failures", tally.silent_failures},
          {"ok_and_wrong_max_s", tally.silent_max_s},
          {"said_after_s", json_of(summarise(tally.said_after_s))},
          {"recovered", tally.recovered_after_s.size()},
          {"recovered_after_s", json_of(summarise(tally.recovered_after_s))},
          {"final_error_m", json_of(summarise(tally.final_errors_m))},
          {"ok_share", tally.share_of(HealthState::kOk)},
          {"degraded_share", tally.share_of(HealthState::kDegraded)},
          {"lost_share", tally.share_of(HealthState::kLost)},
          {"fault_share", tally.share_of(HealthState::kFault)},
          {"ok_right_share", tally.share_right(HealthState::kOk)},
          {"calibration", json_of(tally.calibration)}};
}

nlohmann::ordered_json finite(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

nlohmann::ordered_json json_of(const RunResult& run) {
  const Fault& fault = run.scenario.fault;
  const Verdict& verdict = run.verdict;
  return {{"index", run.scenario.index},
          {"kind", spec_of(fault.kind).name},
          {"variant", fault.variant},
          {"severity", fault.severity},
          {"start_s", fault.start_s},
          {"end_s", fault.end_s},
          {"world", run.scenario.world},
          {"path_start_s", run.scenario.path_start_s},
          {"laser", run.scenario.laser},
          {"duration_s", run.scenario.duration_s},
          {"silent_failure", verdict.failed_silently()},
          {"ok_and_wrong_s", verdict.silent_s},
          {"ok_and_wrong_from_s", verdict.silent_from_s},
          {"said_after_s", verdict.said_after_s},
          {"recovered_after_s", finite(verdict.recovered_after_s)},
          {"settled_after_s", finite(verdict.settled_after_s)},
          {"final_error_m", verdict.final_error_m},
          {"final_error_deg", to_deg(verdict.final_error_rad)},
          {"scans", verdict.all_scans()},
          {"lost_scans", verdict.scans.at(static_cast<std::size_t>(HealthState::kLost))}};
}

/// Runs of one length of gap.
struct GapLine {
  int runs = 0;
  int silent = 0;
  int known = 0;
  int stays_known = 0;
  int settled = 0;        ///< to 0.10 m within 10 s, of those where the map knows the place and the next 10 s of way
  int settled_known = 0;  ///< the same of those where it knows the place
  double silent_max_s = 0.0;
  std::vector<double> settled_after_s{};
  double error_before_max_m = 0.0;

  void add(const GapResult& gap) {
    constexpr double kInTime_s = 10.0;
    const Verdict& verdict = gap.run.verdict;
    const bool in_time = verdict.settled_after_s <= kInTime_s;
    ++runs;
    silent += verdict.failed_silently() ? 1 : 0;
    known += gap.is_known() ? 1 : 0;
    stays_known += gap.stays_known() ? 1 : 0;
    settled += gap.stays_known() && in_time ? 1 : 0;
    settled_known += gap.is_known() && in_time ? 1 : 0;
    silent_max_s = std::max(silent_max_s, verdict.silent_s);
    error_before_max_m = std::max(error_before_max_m, gap.error_before_m);
    if (gap.is_known() && std::isfinite(verdict.settled_after_s)) {
      settled_after_s.push_back(verdict.settled_after_s);
    }
  }

  [[nodiscard]] std::string text(const std::string& name) const {
    const Statistics after = summarise(settled_after_s);
    return fmt::format("{:12} {:5} {:7} {:8.1f} {:>9} {:>9} {:>6} {:>6} {:12.2f}\n", name, runs, silent, silent_max_s,
                       fmt::format("{}/{}", settled_known, known), fmt::format("{}/{}", settled, stays_known),
                       figure_of(after.count > 0, after.median), figure_of(after.count > 0, after.max),
                       error_before_max_m);
  }
};

}  // namespace

std::string report_text(std::span<const RunResult> runs) {
  std::string text =
      fmt::format("{:12} {:>5} {:>7} {:>8} {:>13} {:>9} {:>13} {:>8} {:>23} {:>8}\n", "", "", "silent", "OK while",
                  "said after, s", "back to", "after, s", "final", "share of scans, %", "OK is");
  text += fmt::format("{:12} {:>5} {:>7} {:>8} {:>6} {:>6} {:>9} {:>6} {:>6} {:>8} {:>7} {:>7} {:>7} {:>8}\n", "fault",
                      "runs", "failure", "wrong, s", "median", "max", "right+OK", "median", "95 %", "error, m", "OK",
                      "degr.", "lost", "right, %");
  for (const FaultSpec& spec : fault_specs()) {
    const Tally tally = tally_of(runs, spec.kind);
    if (tally.runs > 0) {
      text += kind_line(spec.name, tally, has_end(spec.kind));
    }
  }
  const Tally all = tally_of(runs);
  const Tally fault_free = tally_of(runs, FaultKind::kNone);
  text += kind_line("all", all, false) + calibration_text(all.calibration) + failure_lines(runs);
  text += fmt::format(
      "{} runs, {} silent failures; false LOST {:.3f} % of the scans of {} fault-free runs; {:.2f} s of CPU per run\n",
      all.runs, all.silent_failures, kPercent * fault_free.share_of(HealthState::kLost), fault_free.runs,
      all.runs == 0 ? 0.0 : all.cpu_s / all.runs);
  return text;
}

std::string report_text(std::span<const GapResult> gaps) {
  std::string text = fmt::format("{:12} {:>5} {:>7} {:>8} {:>9} {:>9} {:>13} {:>12}\n", "", "", "silent", "OK while",
                                 "place", "and way", "after, s", "error before");
  text += fmt::format("{:12} {:>5} {:>7} {:>8} {:>9} {:>9} {:>6} {:>6} {:>12}\n", "gap", "runs", "failure", "wrong, s",
                      "known", "known", "median", "max", "at most, m");
  std::vector<double> lengths_s;
  for (const GapResult& gap : gaps) {
    lengths_s.push_back(gap.run.scenario.fault.end_s - gap.run.scenario.fault.start_s);
  }
  GapLine all;
  for (const std::string& world : {std::string("rooms"), std::string("office")}) {
    std::vector<double> left_s = lengths_s;
    std::ranges::sort(left_s);
    double done_s = 0.0;
    for (const double length_s : left_s) {
      if (length_s - done_s < 0.5) {
        continue;
      }
      done_s = length_s;
      GapLine line;
      for (std::size_t i = 0; i < gaps.size(); ++i) {
        if (std::abs(lengths_s[i] - length_s) < 0.5 && gaps[i].run.scenario.world == world) {
          line.add(gaps[i]);
          all.add(gaps[i]);
        }
      }
      text += line.runs > 0 ? line.text(fmt::format("{} {:.0f} s", world, length_s)) : "";
    }
  }
  text += all.text("all") + failure_lines(runs_of(gaps));
  return text + fmt::format(
                    "{} gaps, {} silent failures; recovered to 0.10 m within 10 s: {} of {} where the map knows "
                    "the place, {} of {} where it also knows the way of these 10 s\n",
                    all.runs, all.silent, all.settled_known, all.known, all.settled, all.stays_known);
}

nlohmann::ordered_json report_json(std::span<const RunResult> runs) {
  const Tally all = tally_of(runs);
  nlohmann::ordered_json json{{"runs", all.runs},
                              {"silent_failures", all.silent_failures},
                              {"false_lost_share", tally_of(runs, FaultKind::kNone).share_of(HealthState::kLost)},
                              {"all", json_of(all)}};
  for (const FaultSpec& spec : fault_specs()) {
    const Tally tally = tally_of(runs, spec.kind);
    if (tally.runs > 0) {
      json["kinds"][std::string(spec.name)] = json_of(tally);
    }
  }
  json["each"] = nlohmann::ordered_json::array();
  for (const RunResult& run : runs) {
    json["each"].push_back(json_of(run));
  }
  return json;
}

nlohmann::ordered_json report_json(std::span<const GapResult> gaps) {
  nlohmann::ordered_json json = report_json(runs_of(gaps));
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    json["each"][i]["error_before_m"] = gaps[i].error_before_m;
    json["each"][i]["known_share"] = gaps[i].known_share;
    json["each"][i]["known_later_share"] = gaps[i].known_later_share;
  }
  return json;
}

Figure report_figure(std::span<const RunResult> runs) {
  const Tally all = tally_of(runs);
  Series curve{"as it is", Mark::kLine, kBlue, {}};
  for (const Calibration::Bin& bin : all.calibration.bins) {
    if (bin.poses > 0) {
      curve.points.push_back({bin.said(), bin.share_right()});
    }
  }
  std::vector<double> after_s = all.said_after_s;
  std::ranges::sort(after_s);
  Series said{"times that the pose became wrong", Mark::kLine, kRed, {{0.0, 0.0}}};
  for (std::size_t i = 0; i < after_s.size(); ++i) {
    said.points.push_back({after_s[i], static_cast<double>(i + 1) / static_cast<double>(after_s.size())});
  }
  said.points.push_back({std::max(Verdict::kSilentFailure_s, said.points.back().x), said.points.back().y});
  Figure figure{.name = "campaign", .caption = "Calibration, and time to say so", .columns = 2};
  figure.panels.push_back({.title = "Calibration",
                           .x_label = "probability of being right that is said",
                           .y_label = "share that is right",
                           .series = {{"as it should be", Mark::kLine, kGreen, {{0.0, 0.0}, {1.0, 1.0}}}, curve}});
  figure.panels.push_back({.title = "Time to say so",
                           .x_label = "time from becoming wrong to not OK (s)",
                           .y_label = "share said by then",
                           .series = {said}});
  return figure;
}

std::vector<RunResult> runs_of(std::span<const GapResult> gaps) {
  std::vector<RunResult> runs;
  for (const GapResult& gap : gaps) {
    runs.push_back(gap.run);
  }
  return runs;
}

int silent_failures(std::span<const RunResult> runs) {
  return static_cast<int>(
      std::ranges::count_if(runs, [](const RunResult& run) { return run.verdict.failed_silently(); }));
}

}  // namespace odoless::campaign
