#include "tools/replay/verdict.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace odoless {
namespace {

/// A share of the scans above which a result is doubtful, and one above which it has failed.
struct Bound {
  std::int64_t RunFigures::*count;
  double doubtful_share;
  double failed_share;
  const char* what;
};

constexpr double kNever = 1.0;

// Lost: a log without faults loses no scan in a thousand; of one that loses a tenth, that part of the way is not
// mapped. On trial: some scans at a start, a turn of a crowd; more than one in fifty is a run that lives on guesses.
// Poor: between two poor matches the motion is guessed. A few are a door that opens; of a fifth, nothing follows.
// Ambiguous: corridors are; where half of all matches are, the place does not tell where one is.
// Outside: what lies there is missing in the map; a beam now and then is not, and one scan in two hundred is a place.
// Untimed: the motion is held by the scans; where a third of the times is unknown, nothing is known of speeds.
constexpr std::array<Bound, 6> kBounds{{
    {&RunFigures::lost, 0.001, 0.1, "were taken while the robot was lost"},
    {&RunFigures::poor, 0.02, 0.2, "match the scans before them poorly"},
    {&RunFigures::doubtful, 0.02, kNever, "have an uncertain pose"},
    {&RunFigures::outside, 0.005, kNever, "reach beyond the grid: what lies there is not in the map"},
    {&RunFigures::ambiguous, 0.5, kNever, "match in several places"},
    {&RunFigures::untimed, 0.33, kNever, "have stamps that do not tell when they were taken"},
}};
constexpr double kMissing_share = 0.02;  // of the time; a robot moves on meanwhile

double share(std::int64_t count, std::int64_t all) {
  return all > 0 ? static_cast<double>(count) / static_cast<double>(all) : 0.0;
}

double percent(std::int64_t count, std::int64_t all) { return 100.0 * share(count, all); }

double missing_share(const RunFigures& figures) {
  return figures.duration_s > 0.0 ? figures.missing_s / figures.duration_s : 0.0;
}

void add(Verdict& verdict, Grade grade, std::string reason) {
  const bool is_worse = grade > verdict.grade;
  verdict.grade = std::max(verdict.grade, grade);
  verdict.reasons.insert(is_worse ? verdict.reasons.begin() : verdict.reasons.end(), std::move(reason));
}

}  // namespace

RunFigures figures_of(const ReplayResult& result) {
  return {.scans = static_cast<std::int64_t>(result.trajectory.size()),
          .lost = result.lost_scans,
          .doubtful = result.doubtful_scans,
          .ok_but_off = result.ok_but_off_scans,
          .drifted = result.drifted_scans,
          .poor = result.poor_matches,
          .ambiguous = result.ambiguous_matches,
          .outside = result.outside_scans,
          .untimed = result.source.times.doubtful,
          .missing_s = result.missing_s,
          .duration_s = result.log_duration_s,
          .is_mapped = !result.map.occupancy_percent.empty()};
}

RunFigures figures_of(std::span<const MatchRow> matches) {
  RunFigures figures;
  figures.scans = static_cast<std::int64_t>(matches.size());
  figures.poor = std::count_if(matches.begin(), matches.end(), [](const MatchRow& row) { return !row.converged; });
  return figures;
}

Verdict judge(const RunFigures& figures) {
  Verdict verdict;
  if (!figures.is_mapped) {
    add(verdict, Grade::kFailed, "nothing was mapped: no scan sees anything within its range");
  }
  for (const Bound& bound : kBounds) {
    const std::int64_t count = figures.*bound.count;
    const double found = share(count, figures.scans);
    if (found > bound.doubtful_share) {
      add(verdict, found > bound.failed_share ? Grade::kFailed : Grade::kDoubtful,
          fmt::format("{} of {} scans ({:.1f} %) {}", count, figures.scans, 100.0 * found, bound.what));
    }
  }
  if (missing_share(figures) > kMissing_share) {
    add(verdict, Grade::kDoubtful,
        fmt::format("for {:.0f} s of {:.0f} s there are no scans", figures.missing_s, figures.duration_s));
  }
  return verdict;
}

const char* name_of(Grade grade) {
  switch (grade) {
    case Grade::kGood:
      return "good";
    case Grade::kDoubtful:
      return "doubtful";
    case Grade::kFailed:
      return "failed";
  }
  return "?";
}

std::string sentence(const Verdict& verdict) {
  std::string text = fmt::format("result: {}", name_of(verdict.grade));
  for (std::size_t i = 0; i < verdict.reasons.size(); ++i) {
    text += (i == 0 ? ": " : "; ") + verdict.reasons[i];
  }
  return text;
}

std::string shares_text(const RunFigures& figures) {
  return fmt::format(
      "{:.1f} % of the scans lost, {:.1f} % with a doubtful pose, {:.1f} % far from a loop closure, {:.1f} % OK but "
      "off the final path, {:.1f} % outside the map; {:.1f} % poor and {:.1f} % "
      "ambiguous matches; {:.1f} % with a doubtful stamp, {:.1f} s without scans",
      percent(figures.lost, figures.scans), percent(figures.doubtful, figures.scans),
      percent(figures.drifted, figures.scans), percent(figures.ok_but_off, figures.scans),
      percent(figures.outside, figures.scans), percent(figures.poor, figures.scans),
      percent(figures.ambiguous, figures.scans), percent(figures.untimed, figures.scans), figures.missing_s);
}

void add_verdict(const RunFigures& figures, const Verdict& verdict, nlohmann::ordered_json& summary) {
  summary["result"] = name_of(verdict.grade);
  summary["reasons"] = verdict.reasons;
  summary["lost_share"] = share(figures.lost, figures.scans);
  summary["doubtful_share"] = share(figures.doubtful, figures.scans);
  summary["ok_but_off_share"] = share(figures.ok_but_off, figures.scans);
  summary["drifted_share"] = share(figures.drifted, figures.scans);
  summary["poor_share"] = share(figures.poor, figures.scans);
  summary["ambiguous_share"] = share(figures.ambiguous, figures.scans);
  summary["outside_share"] = share(figures.outside, figures.scans);
  summary["doubtful_stamp_share"] = share(figures.untimed, figures.scans);
  summary["missing_s"] = figures.missing_s;
}

}  // namespace odoless
