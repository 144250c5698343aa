#include "tools/command/cloud.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <numbers>

#include "config/config.hpp"
#include "tools/cloud/cloud_job.hpp"
#include "tools/command/closing.hpp"
#include "tools/command/parameter_options.hpp"
#include "tools/output/progress.hpp"
#include "tools/output/result_folder.hpp"

namespace odoless {
namespace {

struct CloudOptions {
  CloudJob job;
  std::string config;
  double servo_level_deg = 0.0;
  double clock_ahead_ms = 0.0;
  bool clock_is_given = false;
  bool strict = false;
  bool force = false;
};

CloudJob job_of(const CloudOptions& options) {
  CloudJob job = options.job;
  if (!options.config.empty()) {
    load_parameters(options.config, job.params);
  }
  job.servo.level_rad = options.servo_level_deg * std::numbers::pi / 180.0;
  if (options.clock_is_given) {
    job.clock_ahead_s = options.clock_ahead_ms * 1e-3;
  }
  return job;
}

ReplayProgress show_on(std::unique_ptr<Progress>& bar) {
  return [&bar](std::int64_t done, std::int64_t total, double fitness) {
    if (!bar) {
      bar = std::make_unique<Progress>(total, InPipe::kLines);
    }
    bar->update(done, fmt::format("fitness {:.2f}", fitness));
  };
}

void print(const CloudJob& job, const CloudResult& result) {
  const CloudRun& run = result.run;
  const CloudCheck& check = result.check;
  fmt::print("scans     {} in the cloud, {} level ones made the poses, {} without a pose\n", run.scans_in_cloud,
             run.level_scans, run.scans_without_pose);
  fmt::print("points    {} in {}; {} kept, {} refused\n", result.points.size(), (job.out / "cloud.ply").string(),
             run.mapper.cloud().size(), run.mapper.cloud().refused());
  fmt::print("clocks    the servo's is {:.3f} s ahead of the laser's, {}\n",
             static_cast<double>(result.clock.clock_ahead_ns) * 1e-9,
             !result.clock_is_estimated ? "as given"
             : result.clock.is_told     ? "as the cloud tells"
                                        : "as the log's rows pair them; the cloud does not tell better");
  if (check.saw_enough()) {
    fmt::print("floor     at {:.3f} m, 95 % within {:.3f} m; walls lean by {:.2f} deg on average: {}\n",
               check.floor_height_m, check.floor_deviation_m.percentile_95,
               check.wall_lean_rad.mean * 180.0 / std::numbers::pi,
               check.is_straight() ? "the calibration is right"
                                   : "the calibration is wrong (mapping.mount), or the place not flat");
  } else {
    fmt::print("floor     too little of floor and walls was seen to check the calibration\n");
  }
  if (result.truth) {
    fmt::print("truth     points: median error {:.3f} m, 95th percentile {:.3f} m\n", result.truth->distance_m.median,
               result.truth->distance_m.percentile_95);
  }
  fmt::print("poses     {}\n", shares_text(result.figures));
}

void run(const CloudOptions& options) {
  const CloudJob wanted = job_of(options);
  ResultFolder folder(wanted.out, options.force);
  CloudJob job = wanted;
  job.out = folder.unfinished();
  std::unique_ptr<Progress> bar;
  const CloudResult result = run_cloud_job(job, show_on(bar));
  bar.reset();
  tell_corrections(job.input, result.corrected);
  write_cloud_result(job, result);
  folder.finish();
  print(wanted, result);
  close_job(job.input, result.verdict, options.strict);
}

void add_log_options(CLI::App& command, CloudOptions& options) {
  command.add_option("--servo-level-deg", options.servo_level_deg, "The servo's own angle at the level pose")
      ->check(CLI::Range(-360.0, 360.0))
      ->capture_default_str();
  command.add_flag("--servo-inverted", options.job.servo.inverted, "The servo's angle grows upwards");
  command
      .add_option_function<double>(
          "--clock-ahead-ms",
          [&options](double given_ms) {
            options.clock_ahead_ms = given_ms;
            options.clock_is_given = true;
          },
          "How far the servo's clock is ahead of the laser's [estimated from the cloud]")
      ->check(CLI::Range(-1e9, 1e9));
}

void add_simulation_options(CLI::App& command, CloudOptions& options) {
  options.job.lrf = simulated_lrf_params(*find_lrf_model("utm-30lx"));
  options.job.lrf.distortion = true;
  ParameterOptions parameters(command);
  SimulatedLrfParams::describe(options.job.lrf, parameters);
  ParameterOptions tilt(command, "tilt_");
  TiltMotionParams::describe(options.job.tilt, tilt);
  command
      .add_option("--speed-max-mps", options.job.speed_max_mps, "Drive a simulated robot no faster [as its world says]")
      ->check(CLI::Range(0.01, 10.0));
  command.add_flag("--write-log", options.job.write_log, "Write the simulated log too: tilt_log.csv");
}

}  // namespace

void add_cloud(CLI::App& app) {
  const auto options = std::make_shared<CloudOptions>();
  CLI::App* const command = app.add_subcommand("cloud", "Map in 3D with a tilting laser");
  command
      ->add_option("INPUT", options->job.input,
                   "Tilt log (CSV, also .gz or .xz), or a .world file in which to simulate one")
      ->required();
  command->add_option("--out", options->job.out, "Folder for the results, new or empty")->required();
  command->add_flag("--force", options->force, "Replace the results that are in the folder");
  command->add_option("--config", options->config, "TOML file; its [mapping] has the extrinsic calibration");
  command->add_option("--seed", options->job.seed, "Seed of the random generator")->capture_default_str();
  command->add_option("--keys-shown", options->job.keys_shown, "Also draw the first so many key poses' points alone")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  command->add_flag("--strict", options->strict, "Exit with 65 where the result is not good");
  add_log_options(*command, *options);
  add_simulation_options(*command, *options);
  command->callback([options] { run(*options); });
}

}  // namespace odoless
