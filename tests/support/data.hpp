#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace odoless::test {

/// The folder of recorded logs: the environment variable ODOLESS_DATA, else ../shared/data beside the source tree.
inline std::filesystem::path data_folder() {
  const char* const folder = std::getenv("ODOLESS_DATA");
  return folder != nullptr ? std::filesystem::path(folder)
                           : std::filesystem::path(__FILE__).parent_path() / "../../../shared/data";
}

}  // namespace odoless::test

/// Declares `variable`, the path of a recorded log, or skips the test when it is absent. For use in a test's own body.
#define ODOLESS_DATA_FILE(variable, name)                                                                     \
  const std::filesystem::path variable = ::odoless::test::data_folder() / (name);                             \
  if (!std::filesystem::exists(variable)) {                                                                   \
    GTEST_SKIP() << "no recorded log " << variable << "; set ODOLESS_DATA to the folder that has " << (name); \
  }                                                                                                           \
  static_assert(true)
