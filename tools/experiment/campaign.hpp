#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/experiment/experiment.hpp"

namespace odoless {

/// What is done, with what, and where to.
struct CampaignOptions {
  Sources sources;
  std::filesystem::path out;
  int threads = 1;
};

/// An experiment's claims and pictures as they lie on the disk, or why there are none.
struct Record {
  const Experiment* experiment = nullptr;
  std::string missing;  ///< recorded log that is absent; nothing else is there then
  std::vector<Claim> claims;
  struct Picture {
    std::string name;  ///< in the experiment's folder, without extension
    std::string caption;
  };
  std::vector<Picture> pictures;
};

/// Does what is not yet done: runs in OUT/runs/NAME, then each experiment's tables, figures and result.json in
/// OUT/NAME. What is finished and whose inputs (program, logs, worlds, parameters, seed) are the same stays untouched.
/// A bar on a terminal's stderr says how far it is.
[[nodiscard]] std::vector<Record> conduct(const std::vector<Experiment>& experiments, const CampaignOptions& options);

}  // namespace odoless
