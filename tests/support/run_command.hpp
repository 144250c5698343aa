#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "tools/command/command_line.hpp"

namespace odoless::test {

/// What a command left behind.
struct Outcome {
  int status = 0;
  std::string out;
  std::string err;
};

/// Runs `odoless` with these arguments in this process.
inline Outcome run(const std::vector<std::string>& arguments) {
  std::vector<const char*> argv{"odoless"};
  for (const std::string& argument : arguments) {
    argv.push_back(argument.c_str());
  }
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Outcome outcome;
  outcome.status = run_command_line(static_cast<int>(argv.size()), argv.data());
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

}  // namespace odoless::test
