// Damaged logs in a short, repeatable form; tests/fuzz looks longer.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "core/base/rng.hpp"
#include "tests/support/log_contract.hpp"

namespace odoless {
namespace {

std::vector<std::string> seeds() {
  std::vector<std::string> result;
  const auto corpus = std::filesystem::path(__FILE__).parent_path().parent_path() / "fuzz" / "scan_log_corpus";
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    std::ifstream file(entry.path(), std::ios::binary);
    result.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return result;
}

std::size_t place(Rng& rng, const std::string& text) { return rng.below(static_cast<std::uint32_t>(text.size() + 1)); }

void mutate(Rng& rng, std::string& text) {
  static const std::vector<std::string> kPieces{
      "-1", "99999999999999999999", "nan", "inf", "\n", " ", ",", "1e9", "FLASER", "0", "#", "4e-400", "Laser", "1e40"};
  switch (rng.below(5)) {
    case 0:
      text.resize(place(rng, text));
      break;
    case 1:
      text.erase(place(rng, text), rng.below(12));
      break;
    case 2:
      text.insert(place(rng, text), kPieces[rng.below(static_cast<std::uint32_t>(kPieces.size()))]);
      break;
    case 3:
      text.insert(place(rng, text), text.substr(place(rng, text), rng.below(80)));
      break;
    default:
      if (!text.empty()) {
        text[rng.below(static_cast<std::uint32_t>(text.size()))] = static_cast<char>(rng.below(256));
      }
  }
}

TEST(LogMutation, SeedsAreGoodLogs) {
  ASSERT_EQ(seeds().size(), 6U);
  for (const std::string& seed : seeds()) {
    std::string broken;
    EXPECT_TRUE(test::read_any_bytes(seed, broken)) << seed;
    EXPECT_EQ(broken, "");
  }
}

TEST(LogMutation, DamagedLogsAreRefusedOrConsistent) {
  Rng rng(20);
  int accepted = 0;
  constexpr int kRounds = 4000;
  for (const std::string& seed : seeds()) {
    for (int round = 0; round < kRounds; ++round) {
      std::string text = seed;
      for (std::uint32_t step = 0; step <= rng.below(4); ++step) {
        mutate(rng, text);
      }
      std::string broken;
      accepted += test::read_any_bytes(text, broken) ? 1 : 0;
      ASSERT_EQ(broken, "") << text;
    }
  }
  // Both answers are tested only when both occur.
  EXPECT_GT(accepted, kRounds / 10);
  EXPECT_LT(accepted, 6 * kRounds * 9 / 10);
}

TEST(LogMutation, EveryCutOfAPackedLogIsRefused) {
  for (const std::string& seed : seeds()) {
    if (seed.starts_with('\x1f') || seed.starts_with('\xfd')) {
      for (std::size_t size = 0; size < seed.size(); ++size) {
        std::string broken;
        EXPECT_FALSE(test::read_any_bytes(std::string_view(seed).substr(0, size), broken)) << size;
      }
    }
  }
}

}  // namespace
}  // namespace odoless
