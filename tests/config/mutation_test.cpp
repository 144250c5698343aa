#include <gtest/gtest.h>

#include <string>

#include "config/config.hpp"
#include "core/base/rng.hpp"
#include "tests/config/example_params.hpp"

namespace odoless {
namespace {

// What a hand slips into a file: a changed, lost or doubled letter, or the rest of the file gone.
std::string mutated(std::string text, Rng& rng) {
  const std::uint32_t changes = 1 + rng.below(4);
  for (std::uint32_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = rng.below(static_cast<std::uint32_t>(text.size()));
    switch (rng.below(4)) {
      case 0:
        text[at] = static_cast<char>(rng.below(256));
        break;
      case 1:
        text.erase(at, 1);
        break;
      case 2:
        text.insert(at, 1, "=.[]{}\"'#\n0eE-"[rng.below(14)]);
        break;
      default:
        text.resize(rng.below(8) == 0 ? at : text.size());
    }
  }
  return text;
}

TEST(ParseParameters, AcceptsOrRefusesWhateverAMutationGives) {
  const std::string written = write_toml(ExampleOuterParams{});
  Rng rng(1);
  int accepted = 0;
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    ExampleOuterParams params;
    try {
      parse_parameters(mutated(written, rng), "f", params);
      ++accepted;
    } catch (const ConfigError& error) {
      ++refused;
      ASSERT_FALSE(error.problems().empty());
    }
    ASSERT_TRUE(parameters_in_range(params));
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace odoless
