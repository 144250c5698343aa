// Figures 5.1 to 5.6: population, generations and noise (sections 5.1.1 and 5.1.2 of the dissertation).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/eval/report.hpp"
#include "tools/experiment/groups.hpp"
#include "tools/experiment/matching_claims.hpp"
#include "tools/experiment/seed_runs.hpp"

namespace odoless {
namespace {

constexpr std::array kPopulations{20, 40, 60, 100};
constexpr std::array kGenerations{15, 30, 50, 75};
constexpr std::array kNoisesM{0.015, 0.025, 0.040, 0.080};
constexpr std::int64_t kQuickScans = 140;

/// One setting of a sweep: the run, and how it is called in legends.
struct Setting {
  std::string run;
  std::string label;
};

MatchingSummary summary_of(const Evidence& evidence, const Setting& setting) {
  return summarise_matching(setting.label, evidence.scene(setting.run).truth, evidence.output(setting.run).matches);
}

std::vector<DisplacementError> errors_of(const Evidence& evidence, const std::string& run) {
  return displacement_errors(evidence.output(run).matches, evidence.scene(run).truth.poses);
}

std::vector<PlotPoint> component(std::span<const DisplacementError> errors, double DisplacementError::*member,
                                 double factor) {
  std::vector<PlotPoint> points;
  for (const DisplacementError& error : errors) {
    points.push_back({static_cast<double>(error.index), factor * (error.*member)});
  }
  return points;
}

/// Errors of displacement over the poses, as the dissertation draws them: two settings over one another, worse first.
Figure error_figure(const Evidence& evidence, std::span<const Setting> settings, const std::string& number) {
  constexpr std::array kColours{kRed, kBlue};
  Figure figure{.name = "figure-" + number, .caption = "Figure " + number + ": error in displacement", .panels = {}};
  figure.panels = {{.title = "across the heading", .x_label = "robot pose", .y_label = "error in delta x (mm)"},
                   {.title = "along the heading", .x_label = "robot pose", .y_label = "error in delta y (mm)"},
                   {.title = "rotation", .x_label = "robot pose", .y_label = "error in delta theta (deg)"}};
  constexpr std::array kMembers{&DisplacementError::x_m, &DisplacementError::y_m, &DisplacementError::yaw_rad};
  const std::array factors{1e3, 1e3, to_deg(1.0)};
  for (std::size_t s = 0; s < settings.size(); ++s) {
    const std::vector<DisplacementError> errors = errors_of(evidence, settings[s].run);
    for (std::size_t p = 0; p < figure.panels.size(); ++p) {
      figure.panels[p].series.push_back(
          {settings[s].label, Mark::kLine, kColours.at(s), component(errors, kMembers.at(p), factors.at(p))});
    }
  }
  return figure;
}

/// One row per pair, the components of each setting beside one another.
Table error_table(const Evidence& evidence, std::span<const Setting> settings) {
  Table table{"errors", {"pose"}, {}};
  for (const Setting& setting : settings) {
    for (const char* const axis : {"x_m", "y_m", "yaw_rad"}) {
      table.columns.push_back(fmt::format("{} error_{}", setting.label, axis));
    }
    const std::vector<DisplacementError> errors = errors_of(evidence, setting.run);
    table.rows.resize(errors.size());
    for (std::size_t i = 0; i < errors.size(); ++i) {
      std::vector<double>& row = table.rows[i];
      if (row.empty()) {
        row.push_back(errors[i].index);
      }
      row.insert(row.end(), {errors[i].x_m, errors[i].y_m, errors[i].yaw_rad});
    }
  }
  return table;
}

/// Both figures and the table of four settings.
Findings sweep_findings(const Evidence& evidence, std::span<const Setting> settings, const char* first,
                        const char* second) {
  Findings findings;
  findings.figures = {error_figure(evidence, settings.first(2), first),
                      error_figure(evidence, settings.subspan(2, 2), second)};
  findings.tables = {error_table(evidence, settings)};
  return findings;
}

std::vector<MatchingSummary> summaries_of(const Evidence& evidence, std::span<const Setting> settings) {
  std::vector<MatchingSummary> summaries;
  for (const Setting& setting : settings) {
    summaries.push_back(summary_of(evidence, setting));
  }
  return summaries;
}

std::vector<Setting> settings_of(std::span<const Run> runs, const char* unit, std::span<const double> values) {
  std::vector<Setting> settings;
  for (std::size_t i = 0; i < values.size(); ++i) {
    settings.push_back({runs[i].name, fmt::format("{} {}", unit, values[i])});
  }
  return settings;
}

Findings conclude_population(const Evidence& evidence) {
  const std::vector<double> values(kPopulations.begin(), kPopulations.end());
  const std::vector<Setting> settings = settings_of(evidence.runs(), "N", values);
  Findings findings = sweep_findings(evidence, settings, "5.1", "5.2");
  const std::vector<MatchingSummary> summaries = summaries_of(evidence, settings);
  const std::span all(summaries);
  findings.claims = {small_populations_do_not_converge(all.first(2)),
                     large_populations_have_fewer_and_lower_peaks(all.first(2), all.last(2)),
                     population_converges(all.back()), displacement_is_exact(all.back())};
  return findings;
}

Findings conclude_generations(const Evidence& evidence) {
  const std::vector<double> values(kGenerations.begin(), kGenerations.end());
  const std::vector<Setting> settings = settings_of(evidence.runs(), "G", values);
  Findings findings = sweep_findings(evidence, settings, "5.3", "5.4");
  const std::vector<MatchingSummary> summaries = summaries_of(evidence, settings);
  const std::span all(summaries);
  findings.claims = {generations_refine(all), few_generations_converge_unrefined(all.first(2), all.last(2))};
  return findings;
}

/// Median errors of both settings over the noise.
Figure noise_figure(std::span<const MatchingSummary> seed, std::span<const MatchingSummary> ours) {
  Chart panel{.title = "median error of displacement",
              .x_label = "standard deviation of the range (mm)",
              .y_label = "median error (mm)"};
  panel.series = {{"the dissertation's setting", Mark::kLine, kRed, {}}, {"as built in", Mark::kLine, kBlue, {}}};
  for (std::size_t i = 0; i < seed.size(); ++i) {
    panel.series[0].points.push_back({kNoisesM.at(i) * 1e3, seed[i].median_m * 1e3});
    panel.series[1].points.push_back({kNoisesM.at(i) * 1e3, ours[i].median_m * 1e3});
  }
  return {.name = "noise-and-matcher", .caption = "Not in the dissertation: error over noise", .panels = {panel}};
}

Findings conclude_noise(const Evidence& evidence) {
  std::vector<double> values_mm;
  for (const double noise_m : kNoisesM) {
    values_mm.push_back(noise_m * 1e3);
  }
  const std::vector<Setting> seed_settings = settings_of(evidence.runs(), "sd (mm)", values_mm);
  const std::vector<Setting> our_settings =
      settings_of(evidence.runs().subspan(kNoisesM.size()), "built in, sd (mm)", values_mm);
  Findings findings = sweep_findings(evidence, seed_settings, "5.5", "5.6");
  const std::vector<MatchingSummary> seed = summaries_of(evidence, seed_settings);
  const std::vector<MatchingSummary> ours = summaries_of(evidence, our_settings);
  findings.figures.push_back(noise_figure(seed, ours));
  findings.claims = {error_grows_with_noise(seed), noise_is_survived(seed), default_beats_seed(seed, ours),
                     default_beats_seed_at_worst(seed, ours)};
  return findings;
}

Experiment population_experiment() {
  Experiment experiment{"population", "5.1-5.2", "Population of the optimisation", {}, conclude_population};
  for (const int population : kPopulations) {
    experiment.runs.push_back(seed_pairs(population, kSeedGenerations, kSeedNoiseM));
  }
  return experiment;
}

Experiment generations_experiment() {
  Experiment experiment{"generations", "5.3-5.4", "Generations of the optimisation", {}, conclude_generations};
  for (const int generations : kGenerations) {
    experiment.runs.push_back(seed_pairs(kSeedPopulation, generations, kSeedNoiseM));
  }
  return experiment;
}

Experiment noise_experiment() {
  Experiment experiment{"noise", "5.5-5.6", "Noise of the laser", {}, conclude_noise};
  for (const double noise_m : kNoisesM) {
    experiment.runs.push_back(seed_pairs(kSeedPopulation, kSeedGenerations, noise_m));
  }
  for (const double noise_m : kNoisesM) {
    experiment.runs.push_back(default_pairs(noise_m));
  }
  return experiment;
}

}  // namespace

std::vector<Experiment> matching_experiments(Extent extent) {
  std::vector<Experiment> experiments{population_experiment(), generations_experiment(), noise_experiment()};
  for (Experiment& experiment : experiments) {
    for (Run& run : experiment.runs) {
      if (extent == Extent::kQuick) {
        run.scene.scans_max = kQuickScans;
        run.name += fmt::format("-first-{}", kQuickScans);
      }
    }
  }
  return experiments;
}

}  // namespace odoless
