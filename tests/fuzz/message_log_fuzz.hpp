#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/check.hpp"
#include "tests/support/log_contract.hpp"
#include "tools/log/message_log.hpp"

namespace odoless::test {

/// What the fuzz programs of logs of messages share: each tries its own format alone.
inline int fuzz_log(std::string_view format, const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const MessageFormat* const found = find_message_format(bytes.substr(0, 64));
  if (found != nullptr && format == found->name) {
    std::string broken;
    static_cast<void>(read_any_file(bytes, broken));
    ODOLESS_CHECK(broken.empty());
  }
  return 0;
}

}  // namespace odoless::test
