// Whatever a file holds, reading it ends with a consistent log or a DataError.
#include <cstddef>
#include <cstdint>

#include "core/base/check.hpp"
#include "tests/support/log_contract.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string broken;
  static_cast<void>(odoless::test::read_any_bytes({reinterpret_cast<const char*>(data), size}, broken));
  ODOLESS_CHECK(broken.empty());
  return 0;
}
