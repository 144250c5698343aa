// Figures 5.10 to 5.18: fitness and maps by matches alone on recorded logs (section 5.1.3).
#include <array>

#include "tools/experiment/fitness_claims.hpp"
#include "tools/experiment/groups.hpp"
#include "tools/experiment/plots.hpp"
#include "tools/experiment/recorded_scenes.hpp"
#include "tools/experiment/seed_runs.hpp"
#include "tools/experiment/self_fitness.hpp"

namespace odoless {
namespace {

constexpr double kPointMapResolutionM = 0.05;
constexpr double kWideCellM = 4.0;

Run recorded_pairs(const std::string& name, Scene scene, const MatcherParams& matcher, Extent extent) {
  Run run;
  run.name = name;
  run.scene = std::move(scene);
  run.scene.scans_max = extent == Extent::kQuick ? kQuickRecordedScans : 0;
  run.params.matcher = matcher;
  return run;
}

/// In the dissertation's form.
std::vector<double> fitness_of(const Evidence& evidence, const Run& run) {
  return seed_fitness(evidence.output(run.name).matches, self_scores(evidence.scene(run.name).log, run.params));
}

Table fitness_table(const std::string& name, std::span<const MatchRow> matches, std::span<const double> fitness) {
  Table table{name, {"scan", "dx_m", "dy_m", "dyaw_rad", "fitness", "fitness_seed"}, {}};
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Pose2& motion = matches[i].reference_T_scan;
    table.rows.push_back({static_cast<double>(matches[i].index), motion.x_m, motion.y_m, motion.yaw_rad,
                          matches[i].fitness, fitness[i]});
  }
  return table;
}

/// The scans that a run used, which `every` thins.
ScanLog used_scans(const ScanLog& log, int every) {
  ScanLog used{log.format, log.has_stamps, log.stamp_digits, {}};
  for (std::size_t i = 0; i < log.scans.size(); i += static_cast<std::size_t>(every)) {
    used.scans.push_back(log.scans[i]);
  }
  return used;
}

Chart map_by_matches(const Evidence& evidence, const Run& run, const std::string& title) {
  const std::vector<Pose2> path = chain(evidence.output(run.name).matches, {});
  const ScanLog used = used_scans(evidence.scene(run.name).log, run.every);
  return map_panel(title, map_of_points(used, path, kPointMapResolutionM), {path_series("path", path, kBlue)});
}

/// Fitness of both settings, and the map that the dissertation's gives: figures FIRST and SECOND.
Findings log_findings(const Evidence& evidence, const std::string& first, const std::string& second) {
  const Run& seed = evidence.runs()[0];
  const Run& ours = evidence.runs()[1];
  const std::vector<double> fitness = fitness_of(evidence, seed);
  Findings findings;
  findings.figures = {{.name = "figure-" + first,
                       .caption = "Figure " + first + ": fitness of each displacement",
                       .panels = {fitness_panel("the dissertation's setting", fitness),
                                  fitness_panel("as built in", fitness_of(evidence, ours))}},
                      {.name = "figure-" + second,
                       .caption = "Figure " + second + ": map by scan matching alone",
                       .columns = 2,
                       .panels = {map_by_matches(evidence, seed, "the dissertation's setting"),
                                  map_by_matches(evidence, ours, "as built in")}}};
  findings.tables = {fitness_table("fitness", evidence.output(seed.name).matches, fitness),
                     fitness_table("fitness-built-in", evidence.output(ours.name).matches, fitness_of(evidence, ours))};
  return findings;
}

Findings conclude_dwing(const Evidence& evidence) {
  Findings findings = log_findings(evidence, "5.10", "5.11");
  for (const Run& run : evidence.runs()) {
    findings.claims.push_back(fitness_stays_below("5.10", fitness_of(evidence, run)));
  }
  findings.claims[0].measured += ", with the dissertation's setting";
  findings.claims[1].measured += ", as built in";
  return findings;
}

Findings conclude_in_place_of_cwing(const Evidence& evidence) {
  constexpr double kFew = 0.03;
  Findings findings = log_findings(evidence, "5.12", "5.13");
  findings.claims = {peaks_are_few("5.12", "in C-Wing a few peaks (12 of 1105) are above 30",
                                   fitness_of(evidence, evidence.runs()[0]), kFew)};
  return findings;
}

Findings conclude_in_place_of_diiga(const Evidence& evidence) {
  constexpr double kSome = 0.06;
  Findings findings = log_findings(evidence, "5.14", "5.15");
  findings.claims = {peaks_are_few("5.14", "in Diiga, 1 scan in 5, some peaks (50 of 1874) are above 30",
                                   fitness_of(evidence, evidence.runs()[0]), kSome)};
  return findings;
}

Experiment log_experiment(const char* name, const char* figures, const char* title, Scene scene, Extent extent) {
  const std::string log = name;
  return {log,
          figures,
          title,
          {recorded_pairs(log + "-seed", scene, seed_matcher(kSeedPopulation, kSeedGenerations), extent),
           recorded_pairs(log + "-default", scene, {}, extent)},
          nullptr};
}

/// The runs of the experiment on scans far apart, in their order.
enum SparseRun : std::size_t { kSmallCells, kWideCells, kNoSecondTry, kSecondTrySmall, kSecondTryWide };

Findings conclude_sparse(const Evidence& evidence) {
  constexpr std::array kLabels{"cells of 1000 mm", "cells of 4000 mm", "no second try",
                               "second try with cells as small", "second try with 4000 mm, as built in"};
  const std::span<const Run> runs = evidence.runs();
  const ReferencePoses truth = evidence.scene(runs[0].name).truth;
  std::vector<MatchingSummary> summaries;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    summaries.push_back(summarise_matching(kLabels.at(i), truth, evidence.output(runs[i].name).matches));
  }
  const std::vector<double> small = fitness_of(evidence, runs[kSmallCells]);
  const std::vector<double> wide = fitness_of(evidence, runs[kWideCells]);
  Findings findings;
  findings.figures = {
      {.name = "figure-5.16",
       .caption = "Figure 5.16: fitness of scans far apart",
       .panels = {fitness_panel(kLabels[kSmallCells], small), fitness_panel(kLabels[kWideCells], wide)}},
      {.name = "figure-5.17",
       .caption = "Figure 5.17: poor map",
       .panels = {map_by_matches(evidence, runs[kWideCells], kLabels[kWideCells])}},
      {.name = "figure-5.18",
       .caption = "Figure 5.18: map after a second try of what matched poorly",
       .panels = {map_by_matches(evidence, runs[kSecondTryWide], kLabels[kSecondTryWide])}}};
  findings.tables = {fitness_table("fitness", evidence.output(runs[kSmallCells].name).matches, small)};
  findings.claims = {
      sparse_scans_match_poorly(small), wide_cells_ease_convergence(summaries[kSmallCells], summaries[kWideCells]),
      second_try_needs_wide_cells(summaries[kNoSecondTry], summaries[kSecondTrySmall], summaries[kSecondTryWide])};
  return findings;
}

Experiment sparse_experiment(Extent extent) {
  const MatcherParams small = seed_matcher(kSeedPopulation, kSeedGenerations);
  MatcherParams wide = small;
  wide.reference.ndt.cell_size_m = kWideCellM;
  MatcherParams no_try;
  no_try.score_min = 0.0;
  MatcherParams small_try;
  small_try.reference.wide_cell_size_m = small_try.reference.ndt.cell_size_m;
  Experiment experiment{"sparse",
                        "5.16-5.18",
                        "Scans far apart (Orebro in place of Mine)",
                        {recorded_pairs("sparse-seed-1m", orebro_scene(), small, extent),
                         recorded_pairs("sparse-seed-4m", orebro_scene(), wide, extent),
                         recorded_pairs("sparse-no-second-try", orebro_scene(), no_try, extent),
                         recorded_pairs("sparse-second-try-small", orebro_scene(), small_try, extent),
                         recorded_pairs("sparse-default", orebro_scene(), {}, extent)},
                        conclude_sparse};
  for (Run& run : std::span(experiment.runs).subspan(kNoSecondTry)) {
    run.scene.scans_max = 0;  // fast ones, and the log's hard pairs are few
  }
  return experiment;
}

}  // namespace

std::vector<Experiment> recorded_matching_experiments(Extent extent) {
  constexpr int kDiigaEvery = 5;
  Experiment dwing = log_experiment("dwing", "5.10-5.11", "Matches of D-Wing", dwing_scene(), extent);
  dwing.conclude = conclude_dwing;
  Experiment fr079 = log_experiment("fr079", "5.12-5.13", "Matches of fr079 in place of C-Wing", fr079_scene(), extent);
  fr079.conclude = conclude_in_place_of_cwing;
  Experiment aces = log_experiment("aces", "5.12-5.13", "Matches of aces in place of C-Wing", aces_scene(), extent);
  aces.conclude = conclude_in_place_of_cwing;
  Experiment thinned = log_experiment("fr079-1-in-5", "5.14-5.15", "Matches of fr079, 1 scan in 5, in place of Diiga",
                                      fr079_scene(), extent);
  thinned.conclude = conclude_in_place_of_diiga;
  for (Run& run : thinned.runs) {
    run.every = kDiigaEvery;
    run.scene.scans_max *= kDiigaEvery;
  }
  return {dwing, fr079, aces, thinned, sparse_experiment(extent)};
}

}  // namespace odoless
