#include "tools/command/empty_values.hpp"

#include <CLI/CLI.hpp>
#include <string>

namespace odoless {

void refuse_empty_values(CLI::App& app) {
  for (CLI::Option* const option : app.get_options()) {
    if (option->get_expected_max() > 0) {
      option->check([](const std::string& given) { return given.empty() ? "it is empty" : std::string(); });
    }
  }
  for (CLI::App* const command : app.get_subcommands([](CLI::App*) { return true; })) {
    refuse_empty_values(*command);
  }
}

}  // namespace odoless
