#include "tools/command/closing.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>

#include "tools/command/error.hpp"

namespace odoless {

void tell_corrections(const std::string& log, const std::vector<std::string>& corrected) {
  for (const std::string& correction : corrected) {
    fmt::print(stderr, "odoless: {}: {}\n", log, correction);
  }
}

void close_job(const std::string& log, const Verdict& verdict, bool strict) {
  fmt::print("{}\n", sentence(verdict));
  if (verdict.grade == Grade::kGood) {
    return;
  }
  const std::string text = fmt::format("{}: {}", log, sentence(verdict));
  if (strict) {
    static_cast<void>(std::fflush(stdout));
    throw UserError(65, text);
  }
  if (isatty(STDOUT_FILENO) == 0) {
    fmt::print(stderr, "odoless: {}\n", text);
  }
}

}  // namespace odoless
