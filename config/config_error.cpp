#include "config/config_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

namespace odoless {

ConfigError::ConfigError(std::vector<std::string> problems)
    : std::runtime_error(fmt::format("{}", fmt::join(problems, "\n"))), problems_(std::move(problems)) {}

}  // namespace odoless
