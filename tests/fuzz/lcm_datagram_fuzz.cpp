// Whatever a datagram holds, it is taken apart and decoded within its bounds, and what is accepted is sane.
#include <cstddef>
#include <cstdint>

#include "core/base/check.hpp"
#include "firmware/lcm/channels.hpp"
#include "firmware/lcm/datagram.hpp"
#include "tests/firmware/lcm_decode_contract.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  const odoless::Result<odoless::Datagram> datagram = odoless::parse_datagram(bytes);
  if (datagram.ok()) {
    const std::size_t name_bytes = datagram.value().channel.size();
    ODOLESS_CHECK(name_bytes > 0 && name_bytes <= odoless::kChannelMaxBytes);
    ODOLESS_CHECK(datagram.value().payload.size() == size - 8 - name_bytes - 1);
    ODOLESS_CHECK(odoless::datagram_sequence(bytes).value() == datagram.value().sequence);
    static_cast<void>(odoless::test::decode_any(datagram.value().payload));
  }
  static_cast<void>(odoless::datagram_sequence(bytes));
  static_cast<void>(odoless::test::decode_any(bytes));
  return 0;
}
