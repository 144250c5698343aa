#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <utility>
#include <vector>

#include "tools/command/command_line.hpp"

namespace odoless::test {

/// A sub-command of `odoless` in a process of its own, which ends with it.
class CommandProcess {
 public:
  explicit CommandProcess(const std::vector<std::string>& arguments) {
    process_ = ::fork();
    if (process_ == 0) {
      std::vector<const char*> argv{"odoless"};
      for (const std::string& argument : arguments) {
        argv.push_back(argument.c_str());
      }
      ::_exit(run_command_line(static_cast<int>(argv.size()), argv.data()));
    }
  }
  CommandProcess(const CommandProcess&) = delete;
  CommandProcess& operator=(const CommandProcess&) = delete;
  ~CommandProcess() { static_cast<void>(stop(SIGKILL)); }

  /// Its exit status, or -1.
  int stop(int signal) {
    if (process_ <= 0) {
      return -1;
    }
    ::kill(process_, signal);
    int status = 0;
    ::waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t process_ = -1;
};

}  // namespace odoless::test
