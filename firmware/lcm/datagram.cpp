#include "firmware/lcm/datagram.hpp"

#include <algorithm>

#include "firmware/lcm/channels.hpp"
#include "firmware/lcm/wire_reader.hpp"

namespace odoless {
namespace {

constexpr std::uint32_t kShortMagic = 0x4c433032;     // LC02
constexpr std::uint32_t kFragmentMagic = 0x4c433033;  // LC03

}  // namespace

Result<std::uint32_t> datagram_sequence(std::span<const std::byte> bytes) {
  WireReader reader(bytes);
  const auto magic = reader.unsigned_number<std::uint32_t>();
  const auto sequence = reader.unsigned_number<std::uint32_t>();
  if (!reader.ok() || (magic != kShortMagic && magic != kFragmentMagic)) {
    return Errc::kMalformed;
  }
  return sequence;
}

Result<Datagram> parse_datagram(std::span<const std::byte> bytes) {
  WireReader reader(bytes);
  const auto magic = reader.unsigned_number<std::uint32_t>();
  const auto sequence = reader.unsigned_number<std::uint32_t>();
  if (!reader.ok()) {
    return Errc::kMalformed;
  }
  if (magic != kShortMagic) {
    return magic == kFragmentMagic ? Errc::kTooLong : Errc::kMalformed;
  }
  const std::span<const std::byte> rest = reader.rest();
  const std::span<const std::byte> name = rest.first(std::min(rest.size(), kChannelMaxBytes + 1));
  const auto end = std::find(name.begin(), name.end(), std::byte{0});
  const auto size_bytes = static_cast<std::size_t>(end - name.begin());
  if (end == name.end() || size_bytes == 0) {
    return Errc::kMalformed;
  }
  return Datagram{.sequence = sequence,
                  .channel = {reinterpret_cast<const char*>(name.data()), size_bytes},
                  .payload = rest.subspan(size_bytes + 1)};
}

}  // namespace odoless
