#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>

#include "tools/command/error.hpp"
#include "tools/experiment/figure.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr int kUnavailable = 69;

/// Runs gnuplot in `folder` and returns its wait status; -1 when it can't be run.
int run_gnuplot(const std::filesystem::path& folder, std::string argument) {
  std::string name = "gnuplot";
  const std::array<char*, 3> argv{name.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = posix_spawnp(&child, name.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    return -1;
  }
  int status = -1;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

void check_gnuplot() {
  if (run_gnuplot(".", "--version") != 0) {
    throw UserError(kUnavailable,
                    "gnuplot, which draws the figures, cannot be run; Debian has it in gnuplot-nox, which "
                    "tools/setup installs");
  }
}

void write_figure(const std::filesystem::path& folder, const Figure& figure) {
  const std::string script = figure.name + ".gp";
  write_whole_file(folder / script, gnuplot_script(figure));
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    if (figure.panels[i].picture) {
      write_whole_file(folder / picture_file(figure, i), figure.panels[i].picture->canvas.png());
    }
  }
  if (run_gnuplot(folder, script) != 0) {
    check_gnuplot();
    throw IoError(fmt::format("{}: gnuplot could not draw it", (folder / script).string()));
  }
}

}  // namespace odoless
