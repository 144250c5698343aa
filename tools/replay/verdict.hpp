#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "tools/replay/replay.hpp"

namespace odoless {

/// What a run over a log came to, in counts of scans.
struct RunFigures {
  std::int64_t scans = 0;
  std::int64_t lost = 0;        ///< the robot did not know where it was; not mapped
  std::int64_t doubtful = 0;    ///< its pose was on trial
  std::int64_t ok_but_off = 0;  ///< said to be OK, and more than 0.5 m or 5 deg off the final path
  std::int64_t drifted = 0;     ///< the map may have drifted there, until a later loop closure
  std::int64_t poor = 0;        ///< did not match the scans before
  std::int64_t ambiguous = 0;   ///< matched them in several places
  std::int64_t outside = 0;     ///< reach beyond the grid
  std::int64_t untimed = 0;     ///< whose times are uncertain by more than a quarter of the scan period
  double missing_s = 0.0;       ///< in which there are no scans, in gaps of more than a second
  double duration_s = 0.0;
  bool is_mapped = true;  ///< the map has a cell at all
};

enum class Grade { kGood, kDoubtful, kFailed };

/// Whether a result can be relied on, and if not, why.
struct Verdict {
  Grade grade = Grade::kGood;
  std::vector<std::string> reasons;  ///< a sentence each, the worst first; none for a good one
};

[[nodiscard]] RunFigures figures_of(const ReplayResult& result);
/// Of matches alone: no map, and nothing is lost.
[[nodiscard]] RunFigures figures_of(std::span<const MatchRow> matches);

/// The bounds, with their reasons, are in the source.
[[nodiscard]] Verdict judge(const RunFigures& figures);

/// "good", "doubtful" or "failed".
[[nodiscard]] const char* name_of(Grade grade);
/// "result: doubtful: 12 of 551 scans (2.2 %) ..."
[[nodiscard]] std::string sentence(const Verdict& verdict);
/// The shares, for people: "0.0 % lost, 0.1 % doubtful; 0.3 % poor and 2.0 % ambiguous matches; ...".
[[nodiscard]] std::string shares_text(const RunFigures& figures);
/// `result`, `reasons` and the shares.
void add_verdict(const RunFigures& figures, const Verdict& verdict, nlohmann::ordered_json& summary);

}  // namespace odoless
