#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "tools/experiment/figure.hpp"
#include "tools/experiment/run.hpp"
#include "tools/experiment/table.hpp"

namespace odoless {

/// One of the dissertation's statements, and what became of it.
struct Claim {
  std::string figure;    ///< the dissertation's, such as "5.1"
  std::string stated;    ///< what the dissertation states
  std::string measured;  ///< what we measured
  bool agrees = false;
};

/// What an experiment shows.
struct Findings {
  std::vector<Claim> claims;
  std::vector<Figure> figures;
  std::vector<Table> tables;
};

/// The results that an experiment draws on.
class Evidence {
 public:
  /// @param runs  Where `run_folder` has the finished runs of these.
  Evidence(std::span<const Run> runs, Sources sources, std::filesystem::path runs_folder)
      : runs_(runs), sources_(std::move(sources)), runs_folder_(std::move(runs_folder)) {}

  [[nodiscard]] RunOutput output(const std::string& name) const { return read_run(find(name), runs_folder_ / name); }
  /// Where the files of the run of this name are.
  [[nodiscard]] std::filesystem::path folder(const std::string& name) const { return runs_folder_ / name; }
  /// The scans and true poses that the run of this name was made with.
  [[nodiscard]] SceneData scene(const std::string& name) const { return load_scene(find(name).scene, sources_); }
  [[nodiscard]] std::span<const Run> runs() const { return runs_; }
  [[nodiscard]] const Sources& sources() const { return sources_; }

 private:
  [[nodiscard]] const Run& find(const std::string& name) const;

  std::span<const Run> runs_;
  Sources sources_;
  std::filesystem::path runs_folder_;
};

/// One figure of the dissertation or a group of them.
struct Experiment {
  std::string name;
  std::string figures;  ///< of the dissertation, such as "5.1-5.2"
  std::string title;
  std::vector<Run> runs;
  Findings (*conclude)(const Evidence& evidence) = nullptr;
};

/// Everything at full length, or so little of it that it takes a minute.
enum class Extent { kFull, kQuick };

/// Every experiment, in the order of the dissertation's figures.
[[nodiscard]] std::vector<Experiment> all_experiments(Extent extent);

}  // namespace odoless
