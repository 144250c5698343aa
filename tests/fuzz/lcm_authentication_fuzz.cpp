// Whatever a datagram holds, it is not taken for one of who has the key; and one that was, is not once it is altered.
// The first byte of the input says how: cut or altered by the rest, or made of the rest alone.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/check.hpp"
#include "firmware/lcm/authentication.hpp"

namespace {

constexpr std::int64_t kNow_us = 1'790'000'000'000'000;
constexpr std::string_view kChannel = "ODOLESS_MOTION";

std::vector<std::byte> authentic(odoless::MessageSigner& signer, std::span<const std::byte> message) {
  std::vector<std::byte> all(message.begin(), message.end());
  const auto trailer = signer.sign(kChannel, message, kNow_us);
  all.insert(all.end(), trailer.begin(), trailer.end());
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  const odoless::LcmKey key{std::byte{1}, std::byte{2}};
  odoless::MessageSigner signer(key);
  odoless::MessageVerifier verifier(key);
  ODOLESS_CHECK(!verifier.verify(kChannel, bytes, kNow_us).ok());
  const auto text = std::string_view(reinterpret_cast<const char*>(data), size);
  ODOLESS_CHECK(!odoless::parse_key(text) || size == 64 || size == 65);
  if (size < 2) {
    return 0;
  }
  const std::span<const std::byte> rest = bytes.subspan(1);
  const std::vector<std::byte> whole = authentic(signer, rest.first(rest.size() / 2));
  std::vector<std::byte> altered = whole;
  const std::size_t begin = static_cast<std::size_t>(data[0]) % altered.size();
  for (std::size_t i = 0; i < rest.size() && begin + i < altered.size(); ++i) {
    altered[begin + i] ^= rest[i];
  }
  const auto verified = verifier.verify(kChannel, altered, kNow_us);
  ODOLESS_CHECK(verified.ok() == (altered == whole));
  ODOLESS_CHECK(verifier.verify(kChannel, whole, kNow_us).ok() != verified.ok());
  return 0;
}
