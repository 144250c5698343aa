#include "tools/experiment/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/check.hpp"
#include "tools/experiment/task_pool.hpp"
#include "tools/output/progress.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr const char* kResultFile = "result.json";
constexpr double kConclusionCostS = 2.0;

std::filesystem::path runs_folder(const CampaignOptions& options) { return options.out / "runs"; }

std::string missing_of(const Experiment& experiment, const Sources& sources) {
  for (const Run& run : experiment.runs) {
    if (std::string missing = missing_file(run.scene, sources); !missing.empty()) {
      return missing;
    }
  }
  return {};
}

/// Every run that some experiment needs, once.
std::map<std::string, const Run*> needed_runs(const std::vector<Experiment>& experiments, const Sources& sources) {
  std::map<std::string, const Run*> runs;
  for (const Experiment& experiment : experiments) {
    if (!missing_of(experiment, sources).empty()) {
      continue;
    }
    for (const Run& run : experiment.runs) {
      const auto [known, is_new] = runs.emplace(run.name, &run);
      ODOLESS_CHECK(is_new || run_key(*known->second, sources) == run_key(run, sources));  // a name says all
    }
  }
  return runs;
}

/// Runs the tasks with a bar; `unit` is what the note counts.
void run_with_bar(std::vector<Task> tasks, int threads, const char* unit) {
  double cost_s = 0.0;
  for (const Task& task : tasks) {
    cost_s += task.cost_s;
  }
  const std::size_t count = tasks.size();
  constexpr double kStepsPerS = 10.0;
  Progress bar(std::max<std::int64_t>(1, std::llround(cost_s * kStepsPerS)));
  run_tasks(std::move(tasks), threads, [&](double done_s, int finished) {
    bar.update(std::llround(done_s * kStepsPerS), fmt::format("{} of {} {}", finished, count, unit));
  });
}

void make_runs(const std::vector<Experiment>& experiments, const CampaignOptions& options) {
  std::vector<Task> tasks;
  for (const auto& [name, run] : needed_runs(experiments, options.sources)) {
    const std::filesystem::path folder = runs_folder(options) / name;
    const std::string key = run_key(*run, options.sources);
    if (!is_finished(folder, key)) {
      tasks.push_back({estimate_cost_s(*run), [run = run, folder, key, &options](const ShareDone& done) {
                         std::filesystem::remove_all(folder);
                         compute_run(*run, options.sources, folder, done);
                         mark_finished(folder, key);
                       }});
    }
  }
  run_with_bar(std::move(tasks), options.threads, "runs");
}

/// What an experiment's findings depend on.
std::string experiment_key(const Experiment& experiment, const Sources& sources) {
  std::string key = experiment.name + "\n";
  for (const Run& run : experiment.runs) {
    key += run_key(run, sources);
  }
  return key;
}

nlohmann::ordered_json to_json(const Findings& findings) {
  nlohmann::ordered_json json{{"claims", nlohmann::json::array()}, {"figures", nlohmann::json::array()}};
  for (const Claim& claim : findings.claims) {
    json["claims"].push_back(nlohmann::ordered_json{
        {"figure", claim.figure}, {"stated", claim.stated}, {"measured", claim.measured}, {"agrees", claim.agrees}});
  }
  for (const Figure& figure : findings.figures) {
    json["figures"].push_back(nlohmann::ordered_json{{"name", figure.name}, {"caption", figure.caption}});
  }
  return json;
}

void conclude_into(const Experiment& experiment, const CampaignOptions& options, const std::string& key) {
  const std::filesystem::path folder = options.out / experiment.name;
  std::filesystem::remove_all(folder);
  make_output_folder(folder);
  const Findings findings = experiment.conclude({experiment.runs, options.sources, runs_folder(options)});
  for (const Table& table : findings.tables) {
    write_whole_file(folder / (table.name + ".csv"), format_csv(table));
  }
  for (const Figure& figure : findings.figures) {
    write_figure(folder, figure);
  }
  write_whole_file(folder / kResultFile, to_json(findings).dump(2) + "\n");
  mark_finished(folder, key);
}

void conclude_all(const std::vector<Experiment>& experiments, const CampaignOptions& options) {
  std::vector<Task> tasks;
  for (const Experiment& experiment : experiments) {
    if (!missing_of(experiment, options.sources).empty()) {
      continue;
    }
    const std::string key = experiment_key(experiment, options.sources);
    if (!is_finished(options.out / experiment.name, key)) {
      tasks.push_back({kConclusionCostS,
                       [&experiment, &options, key](const ShareDone&) { conclude_into(experiment, options, key); }});
    }
  }
  run_with_bar(std::move(tasks), options.threads, "figures");
}

Record read_record(const Experiment& experiment, const CampaignOptions& options) {
  Record record{&experiment, missing_of(experiment, options.sources), {}, {}};
  if (!record.missing.empty()) {
    return record;
  }
  const auto json = nlohmann::json::parse(read_whole_file(options.out / experiment.name / kResultFile));
  for (const auto& claim : json["claims"]) {
    record.claims.push_back({claim["figure"], claim["stated"], claim["measured"], claim["agrees"]});
  }
  for (const auto& figure : json["figures"]) {
    record.pictures.push_back({figure["name"], figure["caption"]});
  }
  return record;
}

}  // namespace

std::vector<Record> conduct(const std::vector<Experiment>& experiments, const CampaignOptions& options) {
  make_output_folder(options.out);
  make_runs(experiments, options);
  conclude_all(experiments, options);
  std::vector<Record> records;
  for (const Experiment& experiment : experiments) {
    records.push_back(read_record(experiment, options));
  }
  return records;
}

}  // namespace odoless
