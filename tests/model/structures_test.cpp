// The lock-free structures of the product, as compiled: what they promise holds in every execution of a few operations,
// and with any of their memory orders weaker by a step, or an exchange in two steps, it does not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "tests/model/scenarios.hpp"

namespace odoless::model {
namespace {

std::string text_of(const Mutant& mutant) {
  constexpr std::array kTexts{"acquire", "release", "acquire where it fails", "being one step", "the total order"};
  const std::string_view file = mutant.site.file.substr(mutant.site.file.rfind('/') + 1);
  return fmt::format("{}:{}: {} without {}", file, mutant.site.line, mutant.site.function,
                     kTexts.at(static_cast<std::size_t>(mutant.weakening)));
}

/// The first program that refutes it; empty: none.
std::string refuted_by(const Mutant& mutant, const std::vector<Program>& users) {
  for (const Program& program : users) {
    const Verdict verdict = Explorer(mutant).explore(program);
    if (!verdict.problem.empty()) {
      return fmt::format("{}, execution {}: {}", program.name, verdict.executions,
                         verdict.problem.substr(0, verdict.problem.find('\n')));
    }
  }
  return "";
}

TEST(Structures, KeepTheirPromisesInEveryExecutionAndNeedEachOrderForIt) {
  std::map<Mutant, std::vector<Program>> users;
  for (const Program& program : programs()) {
    Explorer explorer;
    const Verdict verdict = explorer.explore(program);
    fmt::print("{}: {} executions\n", program.name, verdict.executions);
    EXPECT_EQ(verdict.problem, "") << program.name;
    for (const Mutant& mutant : explorer.mutants()) {
      users[mutant].push_back(program);
    }
  }
  for (const auto& [mutant, programs] : users) {
    const std::string refuted = refuted_by(mutant, programs);
    fmt::print("{}: {}\n", text_of(mutant), refuted.empty() ? "nothing is found" : refuted);
    EXPECT_NE(refuted, "") << text_of(mutant) << ": is stronger than needed, or no program shows why not";
  }
}

}  // namespace
}  // namespace odoless::model
