#include <cstddef>
#include <cstdint>
#include <string_view>

#include "config/config.hpp"
#include "core/base/check.hpp"
#include "tests/config/example_params.hpp"

/// Any bytes are either a configuration in range, or refused with a reason.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size_bytes) {
  odoless::ExampleOuterParams params;
  try {
    odoless::parse_parameters({reinterpret_cast<const char*>(data), size_bytes}, "fuzz", params);
    ODOLESS_CHECK(odoless::parameters_in_range(params));
  } catch (const odoless::ConfigError& error) {
    ODOLESS_CHECK(!error.problems().empty());
  }
  return 0;
}
