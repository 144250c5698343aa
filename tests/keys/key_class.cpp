#include "tests/keys/key_class.hpp"

#include "rt/real_time_thread.hpp"

namespace odoless::test {

std::string lack_of_real_time() {
  RealTimeThread probe({.name = "keys-probe", .priority = 1});
  const bool is_allowed = probe.start([] {}) == 0 && probe.scheduling_error() == 0;
  probe.join();
  return is_allowed ? ""
                    : "no real-time priority is allowed here (ulimit -r), without which a priority changes nothing";
}

std::vector<KeyClass> key_classes() {
  std::vector<KeyClass> classes{mapping_class(), laser_class(), tilt_class(), gpio_class(), web_class(), world_class()};
  for (const std::vector<KeyClass>& more : {slam_classes(), thread_classes(), publisher_classes()}) {
    classes.insert(classes.end(), more.begin(), more.end());
  }
  return classes;
}

std::vector<const KeyClass*> classes_of(std::string_view key, const std::vector<KeyClass>& classes) {
  std::vector<const KeyClass*> longest;
  std::size_t length = 0;
  for (const KeyClass& one : classes) {
    for (const std::string& prefix : one.prefixes) {
      if (!key.starts_with(prefix) || prefix.size() < length) {
        continue;
      }
      if (prefix.size() > length) {
        longest.clear();
        length = prefix.size();
      }
      longest.push_back(&one);
    }
  }
  return longest;
}

}  // namespace odoless::test
