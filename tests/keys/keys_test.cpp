#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "config/config.hpp"
#include "tests/keys/key_class.hpp"

// Every key of the configuration does something that a user can see: changed, it changes what comes out, or is refused
// with a message. The keys are the program's own list, that of `odoless config reference`.
namespace odoless {
namespace {

using test::classes_of;
using test::key_classes;
using test::KeyClass;
using test::Scene;
using Value = Entry::Value;

const std::vector<KeyClass>& all_classes() {
  static const std::vector<KeyClass> kClasses = key_classes();
  return kClasses;
}

template <class Number>
std::vector<Value> other_numbers(Number now, Number min, Number max) {
  std::vector<Value> values;
  const auto add = [&](double wanted) {
    const double rounded = std::is_integral_v<Number> ? std::round(wanted) : wanted;
    const auto value = static_cast<Number>(std::clamp(rounded, static_cast<double>(min), static_cast<double>(max)));
    if (value != now && std::find(values.begin(), values.end(), Value(value)) == values.end()) {
      values.emplace_back(value);
    }
  };
  const auto from = static_cast<double>(now);
  if (now == 0) {
    const double top = std::min(static_cast<double>(max), 100.0);
    for (const double share : {0.01, 0.1, 0.5, 1.0}) {
      add(share * top);
    }
  } else {
    for (const double ratio : {2.0, 0.5, 10.0, 0.1}) {
      add(ratio * from);
    }
  }
  add(from + 1.0);
  add(static_cast<double>(min));
  return values;
}

/// Other values that a file may give this key, the nearer ones first.
std::vector<Value> other_values(const Entry& entry) {
  const Value now = entry.get();
  if (!entry.names.empty()) {
    std::vector<Value> values;
    for (const char* const name : entry.names) {
      if (Value(std::string(name)) != now) {
        values.emplace_back(std::string(name));
      }
    }
    return values;
  }
  if (const auto* const flag = std::get_if<bool>(&now)) {
    return {Value(!*flag)};
  }
  if (std::holds_alternative<Entry::Sectors>(now)) {
    return {Value(Entry::Sectors{{-30.0, 30.0}})};
  }
  if (const auto* const text = std::get_if<std::string>(&now)) {
    return {Value(*text + "2")};
  }
  if (const auto* const whole = std::get_if<std::int64_t>(&now)) {
    return other_numbers(*whole, std::get<std::int64_t>(entry.min), std::get<std::int64_t>(entry.max));
  }
  return other_numbers(std::get<double>(now), std::get<double>(entry.min), std::get<double>(entry.max));
}

/// A scene, its configuration, and what it looks like by that.
class Stage {
 public:
  explicit Stage(const Scene& scene) : scene_(scene) {
    for (const std::string& toml : scene.tomls) {
      parse_parameters(toml, scene.name, params_);
    }
    usual_ = scene.look(params_);
    EXPECT_EQ(usual_, scene.look(params_)) << scene.name << ": the same configuration must give the same";
  }

  /// Whether the user sees it where the key has another value.
  [[nodiscard]] bool shows(const std::string& key) const {
    DaemonParams params = params_;
    const std::vector<Entry> entries = entries_of(params);
    const auto entry = std::find_if(entries.begin(), entries.end(), [&](const Entry& any) { return any.key == key; });
    const std::vector<Value> values = other_values(*entry);
    return std::any_of(values.begin(), values.end(), [&](const Value& value) {
      entry->set(value);
      return scene_.look(params) != usual_;
    });
  }

 private:
  const Scene& scene_;
  DaemonParams params_;
  std::string usual_;
};

class KeysOf : public ::testing::TestWithParam<int> {};

TEST_P(KeysOf, ThisClassEachChangeWhatAUserSees) {
  const KeyClass& tested = all_classes()[static_cast<std::size_t>(GetParam())];
  if (const std::string lack = tested.lack(); !lack.empty()) {
    GTEST_SKIP() << lack;
  }
  const std::vector<Scene> scenes = tested.scenes();
  std::vector<Stage> stages(scenes.begin(), scenes.end());
  std::vector<int> shown(stages.size());
  std::vector<std::string> idle;
  DaemonParams params;
  for (const Entry& entry : entries_of(params)) {
    if (classes_of(entry.key, all_classes()) != std::vector{&tested}) {
      continue;
    }
    const auto stage =
        std::find_if(stages.begin(), stages.end(), [&](const Stage& any) { return any.shows(entry.key); });
    if (stage == stages.end()) {
      idle.push_back(entry.key);
    } else {
      ++shown[static_cast<std::size_t>(stage - stages.begin())];
    }
  }
  EXPECT_THAT(idle, ::testing::IsEmpty()) << "these keys change nothing: delete them, or make them act";
  for (std::size_t i = 0; i < stages.size(); ++i) {
    EXPECT_GT(shown[i], 0) << "the scene '" << scenes[i].name << "' shows no key";
  }
}

INSTANTIATE_TEST_SUITE_P(Class, KeysOf, ::testing::Range(0, static_cast<int>(all_classes().size())),
                         [](const auto& about) { return all_classes()[static_cast<std::size_t>(about.param)].name; });

TEST(Keys, EachIsInOneClass) {
  DaemonParams params;
  for (const Entry& entry : entries_of(params)) {
    EXPECT_EQ(classes_of(entry.key, all_classes()).size(), 1U) << entry.key;
  }
}

TEST(Keys, EachClassIsOfKeysThatThereAre) {
  DaemonParams params;
  const std::vector<Entry> entries = entries_of(params);
  for (const KeyClass& one : all_classes()) {
    for (const std::string& prefix : one.prefixes) {
      EXPECT_TRUE(std::any_of(entries.begin(), entries.end(),
                              [&](const Entry& entry) { return entry.key.starts_with(prefix); }))
          << one.name << ": " << prefix;
    }
  }
}

}  // namespace
}  // namespace odoless
