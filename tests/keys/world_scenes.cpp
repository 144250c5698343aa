#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "firmware/world/world_keeper.hpp"
#include "tests/keys/key_class.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless::test {
namespace {

/// A world file that is kept up, and whether the first keyframe is in it at once.
std::string kept(const std::filesystem::path& folder, const DaemonParams& params) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  GraphFeed graph(params.robot, 1, false);
  WorldKeeper keeper(params.world, {});
  if (const FileFailure failed = keeper.open(graph); failed.any()) {
    return failed.text;
  }
  EXPECT_EQ(keeper.start(graph), 0);
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<BeamCode> codes{100};
  keeper.add(Keyframe{.stamp_ns = 1000, .angle_step_rad = 0.01, .beams = 1}, codes);
  while (keeper.report().keyframes == 0 && std::chrono::steady_clock::now() - begin < std::chrono::seconds(5)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const bool at_once = std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(750);
  std::string text = at_once ? "written at once\n" : "written later\n";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    text += entry.path().extension() == ".world" || entry.path().extension() == ".world2"
                ? entry.path().filename().string() + "\n"
                : "";
  }
  return text;
}

std::vector<Scene> all_world_scenes() {
  const auto folder = std::make_shared<TemporaryFolder>();
  const std::filesystem::path file = std::filesystem::path(folder->path()) / "kept" / "robot.world";
  return {{"kept",
           {fmt::format("[world]\nfile = \"{}\"\n[graph]\nsubmaps_max = 16\nkeyframes_max = 64\n", file.string())},
           [folder, file](const DaemonParams& params) { return kept(file.parent_path(), params); }}};
}

}  // namespace

KeyClass world_class() { return {"world", {"world."}, all_world_scenes}; }

}  // namespace odoless::test
