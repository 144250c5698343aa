#include "firmware/daemon/web_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "firmware/daemon/control_command.hpp"
#include "firmware/daemon/control_server.hpp"

namespace odoless {

bool page_may_ask(std::string_view line) {
  const bool is_one_line = std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; });
  const std::variant<ControlCommand, std::string> parsed = parse_control_command(line);
  const auto* const command = std::get_if<ControlCommand>(&parsed);
  if (!is_one_line || command == nullptr) {
    return false;
  }
  switch (command->kind) {
    case ControlCommand::Kind::kPause:
    case ControlCommand::Kind::kResume:
    case ControlCommand::Kind::kPose:
      return true;
    case ControlCommand::Kind::kSave:
      return command->folder.empty() && !command->is_forced;
    default:
      return false;
  }
}

std::string obey_page(const std::string& socket_path, std::string_view line) {
  if (!page_may_ask(line)) {
    return "error: the page may ask for: pause, resume, save, pose X_M Y_M YAW_DEG\n";
  }
  std::string answer;
  const int error = socket_path.empty() ? ENOENT : send_command(socket_path, line, answer);
  if (error != 0) {
    return fmt::format("error: the control socket (control.socket) does not answer: {}\n",
                       std::strerror(error));  // NOLINT(concurrency-mt-unsafe)
  }
  return answer;
}

}  // namespace odoless
