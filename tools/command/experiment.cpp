#include "tools/command/experiment.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <memory>
#include <thread>

#include "tools/command/error.hpp"
#include "tools/experiment/campaign.hpp"
#include "tools/experiment/html_report.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr const char* kAll = "all";

struct ExperimentOptions {
  std::string name;
  CampaignOptions campaign;
  bool quick = false;
};

std::filesystem::path default_data() {
  const char* const folder = std::getenv("ODOLESS_DATA");  // NOLINT(concurrency-mt-unsafe): before any thread
  return folder != nullptr ? folder : "../shared/data";
}

std::vector<Experiment> chosen(const ExperimentOptions& options) {
  std::vector<Experiment> experiments = all_experiments(options.quick ? Extent::kQuick : Extent::kFull);
  if (options.name != kAll) {
    std::erase_if(experiments, [&](const Experiment& e) { return e.name != options.name; });
  }
  return experiments;
}

void print(const Record& record) {
  const Experiment& experiment = *record.experiment;
  if (!record.missing.empty()) {
    fmt::print("{} ({}): not run: {} is not among the recorded logs (--data, ODOLESS_DATA)\n", experiment.name,
               experiment.figures, record.missing);
  }
  for (const Claim& claim : record.claims) {
    fmt::print("{} ({}): {}: {}; measured: {}\n", experiment.name, claim.figure, claim.agrees ? "agrees" : "DISAGREES",
               claim.stated, claim.measured);
  }
}

void run(const ExperimentOptions& options) {
  check_gnuplot();
  const std::vector<Experiment> experiments = chosen(options);
  const std::vector<Record> records = conduct(experiments, options.campaign);
  const std::filesystem::path report =
      options.campaign.out / (options.name == kAll ? "report.html" : options.name + ".html");
  write_whole_file(report, html_report(records, options.campaign.out));
  for (const Record& record : records) {
    print(record);
  }
  fmt::print("report: {}\n", report.string());
}

std::string footer(const std::vector<Experiment>& experiments) {
  std::string text = "Experiments and the figures that they stand for:\n";
  for (const Experiment& experiment : experiments) {
    text += fmt::format("  {:22} {:10} {}\n", experiment.name, experiment.figures, experiment.title);
  }
  return text;
}

std::vector<std::string> names_of(const std::vector<Experiment>& experiments) {
  std::vector<std::string> names{kAll};
  for (const Experiment& experiment : experiments) {
    names.push_back(experiment.name);
  }
  return names;
}

}  // namespace

void add_experiment(CLI::App& app) {
  const auto options = std::make_shared<ExperimentOptions>();
  const std::vector<Experiment> experiments = all_experiments(Extent::kFull);
  options->campaign.sources.data = default_data();
  options->campaign.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* const command =
      app.add_subcommand("experiment", "Repeat an experiment of the dissertation, and say whether its statements hold");
  command->add_option("NAME", options->name, "Experiment, or all")
      ->required()
      ->check(CLI::IsMember(names_of(experiments)));
  command
      ->add_option("--out", options->campaign.out, "Folder for the results; what is finished there is not done again")
      ->required();
  command->add_option("--data", options->campaign.sources.data, "Folder of recorded logs")->capture_default_str();
  command
      ->add_option("--seed", options->campaign.sources.seed,
                   "Random seed of noise and method: the same seed gives the same bytes")
      ->capture_default_str();
  command->add_option("--jobs", options->campaign.threads, "Threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--quick", options->quick, "Fewer scans and particles: a minute instead of an hour");
  command->footer(footer(experiments));
  command->callback([options] { run(*options); });
}

}  // namespace odoless
