#include "tools/command/control_socket.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "firmware/daemon/daemon_params.hpp"

namespace odoless {
namespace {

/// Empty: the user has no such folder, or something is configured.
std::string own_socket(const std::string& configured) {
  const char* const folder = std::getenv("XDG_RUNTIME_DIR");  // NOLINT(concurrency-mt-unsafe): before any thread
  const bool is_built_in = configured == ControlParams{}.socket;
  return folder != nullptr && *folder == '/' && is_built_in ? std::string(folder) + "/odoless/control" : "";
}

bool may_write_to(const std::filesystem::path& folder) { return ::access(folder.c_str(), W_OK) == 0; }

}  // namespace

std::string socket_to_open(const std::string& configured) {
  const std::string own = own_socket(configured);
  const bool is_root = ::geteuid() == 0;  // who may make the system's folder
  return own.empty() || is_root || may_write_to(std::filesystem::path(configured).parent_path()) ? configured : own;
}

std::string socket_to_ask(const std::string& configured) {
  const std::string own = own_socket(configured);
  return !own.empty() && ::access(own.c_str(), F_OK) == 0 ? own : configured;
}

}  // namespace odoless
