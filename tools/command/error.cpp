#include "tools/command/error.hpp"

#include <fmt/core.h>

#include <system_error>

namespace odoless {

DataError::DataError(const std::string& file, int line, const std::string& wrong, const std::string& right)
    : UserError(65, line > 0 ? fmt::format("{}:{}: {}; expected {}", file, line, wrong, right)
                             : fmt::format("{}: {}; expected {}", file, wrong, right)) {}

std::string system_reason(int error_number) { return std::generic_category().message(error_number); }

}  // namespace odoless
