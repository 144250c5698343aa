#include "tools/command/eval.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "firmware/world/world_reader.hpp"
#include "tools/command/error.hpp"
#include "tools/eval/report.hpp"
#include "tools/output/progress.hpp"
#include "tools/output/world_output.hpp"
#include "tools/replay/places.hpp"

namespace odoless {
namespace {

struct EvalOptions {
  std::string reference;
  std::string estimate;
  Association association;
  double gross_m = 0.2;
  double gross_deg = 5.0;
  bool json = false;
};

void print(const Report& report, bool json) { fmt::print("{}\n", json ? report.json.dump(2) : report.text); }

/// What to say when nothing of the estimate meets the reference.
[[noreturn]] void fail_unmatched(const EvalOptions& options, std::size_t missing) {
  throw DataError(
      options.estimate, 0,
      fmt::format("none of {} comparisons finds its poses within {} s", missing, options.association.tolerance_s),
      fmt::format("stamps of the same clock as in {} (--tolerance-s widens the search)", options.reference));
}

template <class Result>
void finish(const EvalOptions& options, const Result& result) {
  if (result.used == 0) {
    fail_unmatched(options, result.missing);
  }
  print(report(result), options.json);
}

void run_relations(const EvalOptions& options) {
  const auto relations = read_relations(options.reference);
  const ReferencePoses estimate = read_reference_poses(options.estimate);
  finish(options, evaluate_relations(relations, estimate.poses, options.association));
}

void run_ate(const EvalOptions& options) {
  const ReferencePoses reference = read_reference_poses(options.reference);
  const ReferencePoses estimate = read_reference_poses(options.estimate);
  finish(options, evaluate_ate(reference.poses, estimate.poses, options.association));
}

void run_pairs(const EvalOptions& options) {
  const PairsParams params{.association = options.association,
                           .gross_translation_m = options.gross_m,
                           .gross_rotation_rad = to_rad(options.gross_deg)};
  const ReferencePoses reference = read_reference_poses(options.reference);
  finish(options, evaluate_pairs(reference, read_matches(options.estimate), params));
}

struct PlacesOptions {
  std::string world;
  std::string log;
  std::string truth;
  PlacesParams wanted;
  bool json = false;
};

void run_places(const PlacesOptions& options) {
  WorldFile file;
  open_world(options.world, file);
  const WorldReading reading = read_world(file, RobotParams{});
  if (!reading.world) {
    throw DataError(options.world, 0, reading.wrong, "a whole world; `odoless world check` says more");
  }
  const ScanLog log = read_scan_log(options.log);
  const ReferencePoses truth = read_reference_poses(options.truth);
  if (const StampLookup poses(truth.poses); std::ranges::none_of(log.scans, [&](const LogScan& scan) {
        return poses.nearest(static_cast<double>(scan.stamp_ns) * 1e-9, options.wanted.tolerance_s).has_value();
      })) {
    throw DataError(options.truth, 0, fmt::format("it has no pose of any scan of {}", options.log),
                    "the trajectory of a run over that log, with its stamps");
  }
  std::vector<TriedPlace> tried;
  {
    Progress bar(options.wanted.places, InPipe::kLines);
    const StampLookup poses(truth.poses);
    tried = try_places({log, poses}, *reading.world, RobotParams{}, options.wanted,
                       [&](int done) { bar.update(done, {}); });
  }
  print(report(tried, options.wanted), options.json);
}

using Options = std::shared_ptr<EvalOptions>;

CLI::App* add_kind(CLI::App& eval, const Options& options, const char* name, const char* summary) {
  CLI::App* const command = eval.add_subcommand(name, summary);
  command
      ->add_option("--tolerance-s", options->association.tolerance_s,
                   "Largest difference of two stamps that belong together")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command
      ->add_option("--laser-x-m", options->association.laser_x_m,
                   "Distance of the laser in front of the robot's centre, where the reference has that centre")
      ->check(CLI::Range(-10.0, 10.0))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Write one JSON object instead of text");
  return command;
}

void add_relations(CLI::App& eval) {
  auto options = std::make_shared<EvalOptions>();
  CLI::App* const command =
      add_kind(eval, options, "relations", "Compare with hand-verified motions (Kuemmerle et al. 2009)");
  command->add_option("REL", options->reference, "Relations: t1 t2 x y z roll pitch yaw")->required();
  command->add_option("TRAJ", options->estimate, "Estimated trajectory: TUM, or stamp x y yaw")->required();
  command->callback([options] { run_relations(*options); });
}

void add_ate(CLI::App& eval) {
  auto options = std::make_shared<EvalOptions>();
  CLI::App* const command = add_kind(eval, options, "ate", "Absolute trajectory error after rigid alignment");
  command->add_option("REF", options->reference, "Reference: trajectory, or log with poses")->required();
  command->add_option("TRAJ", options->estimate, "Estimated trajectory: TUM, or stamp x y yaw")->required();
  command->callback([options] { run_ate(*options); });
}

void add_pairs(CLI::App& eval) {
  auto options = std::make_shared<EvalOptions>();
  CLI::App* const command = add_kind(eval, options, "pairs", "Errors of pairwise matches, and gross failures");
  command->add_option("REF_LOG", options->reference, "Reference: log with poses, or trajectory")->required();
  command->add_option("MATCHES", options->estimate, "matches.csv of `odoless match` or `odoless replay`")->required();
  command->add_option("--gross-m", options->gross_m, "Error of translation above which a match is a gross failure")
      ->check(CLI::Range(1e-6, 1e6))
      ->capture_default_str();
  command->add_option("--gross-deg", options->gross_deg, "Error of rotation above which a match is a gross failure")
      ->check(CLI::Range(1e-6, 180.0))
      ->capture_default_str();
  command->callback([options] { run_pairs(*options); });
}

void add_places(CLI::App& eval) {
  auto options = std::make_shared<PlacesOptions>();
  CLI::App* const command =
      eval.add_subcommand("places", "Put a robot at random places of a log into a world, and see whether it is found");
  command->add_option("WORLD", options->world, "World file; it stays as it is")->required();
  command->add_option("LOG", options->log, "Recorded log of a drive in that building")->required();
  command->add_option("TRAJ", options->truth, "Where the robot was in the world's frame: TUM, or stamp x y yaw")
      ->required();
  command->add_option("--places", options->wanted.places, "How many")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--seed", options->wanted.seed, "Random seed: the same seed gives the same places")
      ->capture_default_str();
  command->add_option("--in-time-s", options->wanted.in_time_s, "Time of scans within which the robot is to be found")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->add_option("--watched-s", options->wanted.watched_s, "Time of scans that each is watched")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Write one JSON object instead of text");
  command->callback([options] { run_places(*options); });
}

}  // namespace

void add_eval(CLI::App& app) {
  CLI::App* const eval = app.add_subcommand("eval", "Measure an estimate against a reference");
  eval->require_subcommand(1);
  add_relations(*eval);
  add_ate(*eval);
  add_pairs(*eval);
  add_places(*eval);
}

}  // namespace odoless
