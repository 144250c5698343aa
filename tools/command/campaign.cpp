#include "tools/command/campaign.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "tools/command/error.hpp"
#include "tools/experiment/task_pool.hpp"
#include "tools/fault_campaign/report.hpp"
#include "tools/output/progress.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

using campaign::GapResult;
using campaign::GapSweep;
using campaign::RunResult;
using campaign::Scenario;
using campaign::Trace;

constexpr int kSilentFailure = 1;

struct CampaignJob {
  int runs = 60;
  std::uint64_t seed = 1;
  int jobs = 1;
  bool gaps = false;
  bool list = false;
  int only = -1;
  std::string kind;
  std::string json;
  std::string figure;
  std::string trace;
};

std::vector<Scenario> scenarios_of(const CampaignJob& job) {
  if (job.gaps) {
    const GapSweep sweep(job.seed);
    return {sweep.scenarios().begin(), sweep.scenarios().end()};
  }
  std::vector<Scenario> scenarios;
  for (int i = 0; i < job.runs; ++i) {
    scenarios.push_back(job.kind.empty() ? campaign::draw_scenario(job.seed, i)
                                         : campaign::draw_scenario(job.seed, i, campaign::find_fault(job.kind)->kind));
  }
  return scenarios;
}

/// Does `play(i)` for each of so many groups of runs of one size, on all threads.
template <class Play>
void play_all(const CampaignJob& job, int groups, int group_size, Play play) {
  std::vector<Task> tasks;
  for (int i = 0; i < groups; ++i) {
    tasks.push_back({1.0, [i, &play](const ShareDone&) { play(i); }});
  }
  Progress bar(std::int64_t{groups} * group_size, InPipe::kLines);
  run_tasks(std::move(tasks), job.jobs,
            [&](double, int finished) { bar.update(std::int64_t{finished} * group_size, "runs"); });
}

std::vector<RunResult> play_runs(const CampaignJob& job) {
  const std::vector<Scenario> scenarios = scenarios_of(job);
  std::vector<RunResult> results(scenarios.size());
  play_all(job, static_cast<int>(scenarios.size()), 1, [&](int i) {
    results[static_cast<std::size_t>(i)] = campaign::play(scenarios[static_cast<std::size_t>(i)]);
  });
  return results;
}

std::vector<GapResult> play_sweep(const CampaignJob& job) {
  const GapSweep sweep(job.seed);
  std::vector<std::vector<GapResult>> groups(static_cast<std::size_t>(sweep.groups()));
  play_all(job, sweep.groups(), GapSweep::kLengths,
           [&](int i) { groups[static_cast<std::size_t>(i)] = campaign::play_gaps(sweep.group(i)); });
  std::vector<GapResult> results;
  for (const std::vector<GapResult>& group : groups) {
    results.insert(results.end(), group.begin(), group.end());
  }
  return results;
}

Scenario the_only(const CampaignJob& job) {
  const std::vector<Scenario> scenarios = scenarios_of(job);
  if (job.only >= static_cast<int>(scenarios.size())) {
    throw UsageError(
        fmt::format("--only {}: there are {} runs; expected less, or more --runs", job.only, scenarios.size()));
  }
  return scenarios[static_cast<std::size_t>(job.only)];
}

template <class Result>
int report(const CampaignJob& job, const std::vector<Result>& results, std::span<const RunResult> runs) {
  fmt::print("{}", campaign::report_text(std::span<const Result>(results)));
  if (!job.json.empty()) {
    write_whole_file(job.json, campaign::report_json(std::span<const Result>(results)).dump(2) + "\n");
  }
  if (!job.figure.empty()) {
    const std::filesystem::path file = std::filesystem::absolute(job.figure);
    Figure figure = campaign::report_figure(runs);
    figure.name = file.stem().string();
    write_figure(file.parent_path(), figure);
  }
  return campaign::silent_failures(runs);
}

int conduct_gaps(const CampaignJob& job, Trace* trace) {
  std::vector<GapResult> results;
  if (job.only >= 0) {
    const Scenario only = the_only(job);
    results = campaign::play_gaps({&only, 1}, trace);
  } else {
    results = play_sweep(job);
  }
  return report(job, results, campaign::runs_of(results));
}

int conduct_runs(const CampaignJob& job, Trace* trace) {
  const std::vector<RunResult> results =
      job.only >= 0 ? std::vector<RunResult>{campaign::play(the_only(job), trace)} : play_runs(job);
  return report(job, results, results);
}

void list(const CampaignJob& job) {
  for (const Scenario& scenario : scenarios_of(job)) {
    fmt::print("{}\n", campaign::describe(scenario));
  }
}

void check(const CampaignJob& job) {
  if (!job.trace.empty() && job.only < 0) {
    throw UsageError("--trace is of one run; expected --only INDEX with it");
  }
  if (job.gaps && !job.kind.empty()) {
    throw UsageError("--gaps and --kind name different runs; expected one of them");
  }
  if (!job.figure.empty()) {
    if (std::filesystem::path(job.figure).extension() != ".png") {
      throw UsageError(fmt::format("--figure {}: expected a name that ends in .png", job.figure));
    }
    check_gnuplot();
  }
}

void run(const CampaignJob& job) {
  check(job);
  if (job.list) {
    return list(job);
  }
  Trace trace;
  Trace* const wanted = job.trace.empty() ? nullptr : &trace;
  const int failures = job.gaps ? conduct_gaps(job, wanted) : conduct_runs(job, wanted);
  if (wanted != nullptr) {
    write_whole_file(job.trace, trace.text);
  }
  static_cast<void>(std::fflush(stdout));  // before the reason of the exit status
  if (failures > 0) {
    throw UserError(kSilentFailure,
                    fmt::format("{} silent failures: the daemon said OK for more than 1 s while its pose was more than "
                                "0.5 m or 5 deg wrong",
                                failures));
  }
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const campaign::FaultSpec& spec : campaign::fault_specs()) {
    names.emplace_back(spec.name);
  }
  return names;
}

}  // namespace

void add_campaign(CLI::App& app) {
  const auto job = std::make_shared<CampaignJob>();
  job->jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* const command =
      app.add_subcommand("campaign",
                         "Compare the daemon's state with the truth under simulated faults; exit status 1: it was "
                         "OK with a wrong pose");
  command->add_option("--runs", job->runs, "Runs")->check(CLI::Range(1, 1'000'000))->capture_default_str();
  command->add_option("--seed", job->seed, "Random seed: the same gives the same runs")->capture_default_str();
  command->add_flag("--gaps", job->gaps,
                    "Run the gap sweep instead: 192 runs in which scans are missing for 1 to 12 s");
  command->add_option("--kind", job->kind, "Run only this kind of fault")->check(CLI::IsMember(kind_names()));
  command->add_flag("--list", job->list, "Print the runs, and run none");
  command->add_option("--only", job->only, "Run only the run with this index")->check(CLI::NonNegativeNumber);
  command->add_option("--trace", job->trace, "CSV file of what that run saw, a line per scan and per 0.1 s");
  command->add_option("--json", job->json, "File for all figures");
  command->add_option("--figure", job->figure, "PNG of the calibration curve and the time to detection");
  command->add_option("--jobs", job->jobs, "Threads")->check(CLI::Range(1, 1024))->capture_default_str();
  command->callback([job] { run(*job); });
}

}  // namespace odoless
