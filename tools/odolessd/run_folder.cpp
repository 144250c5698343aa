#include "tools/odolessd/run_folder.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <system_error>
#include <utility>

#include "tools/command/error.hpp"
#include "tools/output/result_folder.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

std::filesystem::path take_name(ResultFolder& results, const std::filesystem::path& folder) {
  const std::string name = fmt::format("{:%Y-%m-%dT%H-%M-%SZ}", fmt::gmtime(std::time(nullptr)));
  constexpr int kTries = 10'000;  // a clock that begins anew with each start
  for (int i = 1; i <= kTries; ++i) {
    const std::filesystem::path path = folder / (i == 1 ? name : fmt::format("{}-{}", name, i));
    if (results.take_name(path)) {
      return path;
    }
  }
  throw CannotCreateError(fmt::format("{}: {} and its like are taken", folder.string(), name), EEXIST);
}

// Where there are no links, or somebody's own file is in its place, there is none.
void link_latest(const std::filesystem::path& run) {
  const std::filesystem::path link = run.parent_path() / "latest";
  const std::filesystem::path unfinished = run.parent_path() / fmt::format(".latest-{}", ::getpid());
  std::error_code error;
  if (const auto status = std::filesystem::symlink_status(link, error);
      std::filesystem::exists(status) && !std::filesystem::is_symlink(status)) {
    return;
  }
  std::filesystem::remove(unfinished, error);
  std::filesystem::create_symlink(run.filename(), unfinished, error);
  if (!error) {
    std::filesystem::rename(unfinished, link, error);
    synchronise_folder(run.parent_path());
  }
}

}  // namespace

std::filesystem::path RunFolder::save(const std::function<void(const std::filesystem::path&)>& write) {
  // Its name is given to it in the end.
  ResultFolder results(folder_ / fmt::format(".run-{}", ::getpid()), false);
  write(results.unfinished());
  const std::filesystem::path saved = take_name(results, folder_);
  link_latest(saved);
  if (const std::filesystem::path before = std::exchange(last_, saved); !before.empty() && before != saved) {
    remove_result_folder(before);
  }
  return saved;
}

}  // namespace odoless
