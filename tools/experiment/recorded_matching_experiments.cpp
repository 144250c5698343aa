// Figures 5.10 to 5.18: fitness and maps by matches alone on recorded logs (section 5.1.3).
#include "tools/experiment/fitness_claims.hpp"
#include "tools/experiment/groups.hpp"
#include "tools/experiment/plots.hpp"
#include "tools/experiment/recorded_scenes.hpp"
#include "tools/experiment/seed_runs.hpp"

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

Table fitness_table(std::span<const MatchRow> matches) {
  Table table{"fitness", {"scan", "dx_m", "dy_m", "dyaw_rad", "fitness_seed"}, {}};
  for (const MatchRow& match : matches) {
    const Pose2& motion = match.reference_T_scan;
    table.rows.push_back(
        {static_cast<double>(match.index), motion.x_m, motion.y_m, motion.yaw_rad, seed_fitness(match)});
  }
  return table;
}

/// The scans that a run used, which `every` thins.
ScanLog used_scans(const ScanLog& log, int every) {
  ScanLog used{log.format, log.has_stamps, {}};
  for (std::size_t i = 0; i < log.scans.size(); i += static_cast<std::size_t>(every)) {
    used.scans.push_back(log.scans[i]);
  }
  return used;
}

Panel map_by_matches(const Evidence& evidence, const Run& run, const std::string& title) {
  const std::vector<Pose2> path = chain(evidence.output(run.name).matches, {});
  const ScanLog used = used_scans(evidence.scene(run.name).log, run.every);
  return map_panel(title, map_of_points(used, path, kPointMapResolutionM), {path_series("path", path, kBlue)});
}

/// Fitness of both settings, and the map that the seed's gives: figures FIRST and SECOND.
Findings log_findings(const Evidence& evidence, const std::string& first, const std::string& second) {
  const Run& seed = evidence.runs()[0];
  const Run& ours = evidence.runs()[1];
  const std::vector<MatchRow> matches = evidence.output(seed.name).matches;
  Findings findings;
  findings.figures = {{.name = "figure-" + first,
                       .caption = "Figure " + first + ": fitness of each displacement",
                       .panels = {fitness_panel("the seed's setting", matches),
                                  fitness_panel("as built in", evidence.output(ours.name).matches)}},
                      {.name = "figure-" + second,
                       .caption = "Figure " + second + ": map by scan matching alone",
                       .columns = 2,
                       .panels = {map_by_matches(evidence, seed, "the seed's setting"),
                                  map_by_matches(evidence, ours, "as built in")}}};
  findings.tables = {fitness_table(matches)};
  return findings;
}

Findings conclude_dwing(const Evidence& evidence) {
  Findings findings = log_findings(evidence, "5.10", "5.11");
  findings.claims = {fitness_stays_below("5.10", evidence.output(evidence.runs()[0].name).matches)};
  return findings;
}

Findings conclude_in_place_of_cwing(const Evidence& evidence) {
  constexpr double kFew = 0.03;
  Findings findings = log_findings(evidence, "5.12", "5.13");
  findings.claims = {peaks_are_few("5.12", "in C-Wing a few peaks (12 of 1105) are above 30",
                                   evidence.output(evidence.runs()[0].name).matches, kFew)};
  return findings;
}

Findings conclude_in_place_of_diiga(const Evidence& evidence) {
  constexpr double kSome = 0.06;
  Findings findings = log_findings(evidence, "5.14", "5.15");
  findings.claims = {peaks_are_few("5.14", "in Diiga, 1 scan in 5, some peaks (50 of 1874) are above 30",
                                   evidence.output(evidence.runs()[0].name).matches, kSome)};
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

Findings conclude_sparse(const Evidence& evidence) {
  const std::span<const Run> runs = evidence.runs();
  const ReferencePoses truth = evidence.scene(runs[0].name).truth;
  std::vector<std::vector<MatchRow>> matches;
  for (const Run& run : runs) {
    matches.push_back(evidence.output(run.name).matches);
  }
  const MatchingSummary small = summarise_matching("cells of 1000 mm", truth, matches[0]);
  const MatchingSummary wide = summarise_matching("cells of 4000 mm", truth, matches[1]);
  const MatchingSummary ours = summarise_matching("built in, with a second try", truth, matches[2]);
  Findings findings;
  findings.figures = {
      {.name = "figure-5.16",
       .caption = "Figure 5.16: fitness of scans far apart",
       .panels = {fitness_panel(small.label, matches[0]), fitness_panel(wide.label, matches[1])}},
      {.name = "figure-5.17",
       .caption = "Figure 5.17: poor map",
       .panels = {map_by_matches(evidence, runs[1], "cells of 4000 mm")}},
      {.name = "figure-5.18",
       .caption = "Figure 5.18: map after a second try of what matched poorly",
       .panels = {map_by_matches(evidence, runs[2], "as built in: cells of 4000 mm where a match is poor")}}};
  findings.tables = {fitness_table(matches[0])};
  findings.claims = {sparse_scans_match_poorly(matches[0]), wide_cells_ease_convergence(small, wide),
                     escalation_helps(small, wide, ours)};
  return findings;
}

Experiment sparse_experiment(Extent extent) {
  const MatcherParams small = seed_matcher(kSeedPopulation, kSeedGenerations);
  MatcherParams wide = small;
  wide.reference.ndt.cell_size_m = kWideCellM;
  return {"sparse",
          "5.16-5.18",
          "Scans far apart (Orebro in place of Mine)",
          {recorded_pairs("sparse-seed-1m", orebro_scene(), small, extent),
           recorded_pairs("sparse-seed-4m", orebro_scene(), wide, extent),
           recorded_pairs("sparse-default", orebro_scene(), {}, extent)},
          conclude_sparse};
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
