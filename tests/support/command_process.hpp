#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "tools/command/command_line.hpp"

namespace odoless::test {

/// A sub-command of `odoless` in a process of its own, which ends with it.
class CommandProcess {
 public:
  /// @param out  What it prints goes there, if it is not empty.
  explicit CommandProcess(const std::vector<std::string>& arguments, const std::string& out = {}) {
    process_ = ::fork();
    if (process_ == 0) {
      if (!out.empty() && std::freopen(out.c_str(), "w", stdout) == nullptr) {
        ::_exit(127);
      }
      std::vector<const char*> argv{"odoless"};
      for (const std::string& argument : arguments) {
        argv.push_back(argument.c_str());
      }
      const int status = run_command_line(static_cast<int>(argv.size()), argv.data());
      std::fflush(stdout);
      ::_exit(status);
    }
  }
  CommandProcess(const CommandProcess&) = delete;
  CommandProcess& operator=(const CommandProcess&) = delete;
  ~CommandProcess() { static_cast<void>(stop(SIGKILL)); }

  /// Its exit status, or -1.
  int stop(int signal) {
    if (process_ > 0) {
      ::kill(process_, signal);
    }
    return wait();
  }

  /// Until it ends by itself. @return  Its exit status, or -1.
  int wait() {
    int status = 0;
    if (process_ <= 0 || ::waitpid(std::exchange(process_, -1), &status, 0) < 0) {
      return -1;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t process_ = -1;
};

}  // namespace odoless::test
