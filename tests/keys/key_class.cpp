#include "tests/keys/key_class.hpp"

#include <algorithm>

namespace odoless::test {

std::vector<KeyClass> key_classes() {
  std::vector<KeyClass> classes{mapping_class(), laser_class(), tilt_class(), gpio_class()};
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
