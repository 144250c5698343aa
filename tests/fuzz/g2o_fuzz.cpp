// Any bytes as a pose graph: refused with a word, or read and solved without a number that is not finite.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/check.hpp"
#include "tools/command/error.hpp"
#include "tools/log/byte_stream.hpp"
#include "tools/output/g2o.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    odoless::LineReader lines(odoless::view_bytes(bytes, "bytes"), "bytes");
    const odoless::PoseGraph graph = odoless::read_g2o(lines);
    ODOLESS_CHECK(graph.size() > 0);
    ODOLESS_CHECK(!odoless::format_g2o(graph).empty());
    for (const odoless::Constraint& each : graph.constraints()) {
      ODOLESS_CHECK(each.from < graph.size() && each.to < graph.size() && each.from != each.to);
    }
  } catch (const odoless::DataError&) {
    return 0;
  }
  return 0;
}
