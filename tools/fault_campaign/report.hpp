#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "tools/experiment/figure.hpp"
#include "tools/fault_campaign/gap_sweep.hpp"
#include "tools/fault_campaign/tally.hpp"

namespace odoless::campaign {

/// The tables of a campaign: a line per kind of fault, the calibration, and a line per silent failure.
[[nodiscard]] std::string report_text(std::span<const RunResult> runs);
/// Those of a gap sweep: a line per length of gap.
[[nodiscard]] std::string report_text(std::span<const GapResult> gaps);

[[nodiscard]] nlohmann::ordered_json report_json(std::span<const RunResult> runs);
[[nodiscard]] nlohmann::ordered_json report_json(std::span<const GapResult> gaps);

/// Calibration curve, and how soon it was said.
[[nodiscard]] Figure report_figure(std::span<const RunResult> runs);

[[nodiscard]] std::vector<RunResult> runs_of(std::span<const GapResult> gaps);
[[nodiscard]] int silent_failures(std::span<const RunResult> runs);

}  // namespace odoless::campaign
