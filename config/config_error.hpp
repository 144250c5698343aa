#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace odoless {

/// Everything that is wrong with one configuration file: one line per problem, each with file, line, key and what would
/// be right. A program that cannot go on with it exits with EX_CONFIG, 78.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<std::string> problems);

  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
};

}  // namespace odoless
