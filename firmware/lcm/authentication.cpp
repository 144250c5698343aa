// The functions of SHA-256 alone, which OpenSSL calls deprecated, keep their state in place; its newer ones use the
// heap for each message.
#define OPENSSL_SUPPRESS_DEPRECATED
#include "firmware/lcm/authentication.hpp"

#include <fcntl.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <limits>
#include <system_error>
#include <utility>

#include "drivers/io/file_descriptor.hpp"
#include "firmware/lcm/wire_reader.hpp"

namespace odoless {
namespace {

constexpr std::uint32_t kMagic = 0x4f444131;  // ODA1
constexpr std::size_t kTagBytes = std::tuple_size_v<Hmac::Tag>;
constexpr std::size_t kSignedTrailerBytes = kTrailerBytes - kTagBytes;
constexpr std::size_t kDigits = 2 * std::tuple_size_v<LcmKey>;

void take_in(SHA256_CTX& state, std::span<const std::byte> bytes) { SHA256_Update(&state, bytes.data(), bytes.size()); }

Hmac::Tag end_of(SHA256_CTX& state) {
  Hmac::Tag digest{};
  SHA256_Final(reinterpret_cast<unsigned char*>(digest.data()), &state);
  return digest;
}

// A block of the key with each byte of it altered by the pad, as the first that is taken in.
SHA256_CTX begun(const LcmKey& key, std::byte pad) {
  std::array<std::byte, SHA256_CBLOCK> block{};
  std::copy(key.begin(), key.end(), block.begin());
  for (std::byte& byte : block) {
    byte ^= pad;
  }
  SHA256_CTX state{};
  SHA256_Init(&state);
  take_in(state, block);
  OPENSSL_cleanse(block.data(), block.size());
  return state;
}

template <class Unsigned>
std::byte* put(std::byte* at, Unsigned value) {
  for (std::size_t shift = 8 * sizeof(Unsigned); shift > 0; *at++ = static_cast<std::byte>(value >> shift)) {
    shift -= 8;
  }
  return at;
}

Hmac::Tag tag_of(const Hmac& hmac, std::string_view channel, std::span<const std::byte> message,
                 std::span<const std::byte> trailer) {
  constexpr std::byte kEnd{0};
  const std::array pieces{std::as_bytes(std::span(channel)), std::span(&kEnd, 1), message, trailer};
  return hmac.of(pieces);
}

// Empty: that is as it should be.
std::string wrong_with_access(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) {
    return "it is no file";
  }
  return (status.st_mode & (S_IWGRP | S_IRWXO)) == 0 ? "" : "others than its owner may write to it, or all may read it";
}

}  // namespace

std::optional<LcmKey> parse_key(std::string_view text) {
  if (text.size() == kDigits + 1 && text.back() == '\n') {
    text.remove_suffix(1);
  }
  LcmKey key{};
  if (text.size() != kDigits) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < key.size(); ++i) {
    const char* const digits = &text[2 * i];
    std::uint8_t value = 0;
    if (const auto read = std::from_chars(digits, digits + 2, value, 16);
        read.ec != std::errc() || read.ptr != digits + 2) {
      return std::nullopt;
    }
    key.at(i) = static_cast<std::byte>(value);
  }
  return key;
}

Result<LcmKey> read_key(const std::string& path, std::string& reason) {
  const auto fail = [&](const std::string& why) {
    reason = "lcm.key_file '" + path + "': " + why +
             "; a file of 64 hexadecimal digits is needed, the same on both hosts: openssl rand -hex 32 > FILE && "
             "chmod 600 FILE";
    return Errc::kBadAddress;
  };
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!file.valid() || ::fstat(file.get(), &status) != 0) {
    return fail(std::generic_category().message(errno));
  }
  if (const std::string wrong = wrong_with_access(status); !wrong.empty()) {
    return fail(wrong);
  }
  std::array<char, kDigits + 2> text{};
  const ssize_t size_bytes = ::read(file.get(), text.data(), text.size());
  const std::optional<LcmKey> key =
      parse_key({text.data(), static_cast<std::size_t>(std::max<ssize_t>(size_bytes, 0))});
  OPENSSL_cleanse(text.data(), text.size());
  return key ? Result<LcmKey>(*key) : Result<LcmKey>(fail("it holds something else"));
}

struct Hmac::States {
  SHA256_CTX inner{};
  SHA256_CTX outer{};
};

Hmac::Hmac(const LcmKey& key)
    : states_(new States{.inner = begun(key, std::byte{0x36}), .outer = begun(key, std::byte{0x5c})}) {}
Hmac::~Hmac() {
  if (states_) {
    OPENSSL_cleanse(states_.get(), sizeof(States));
  }
}
Hmac::Hmac(Hmac&&) noexcept = default;
Hmac& Hmac::operator=(Hmac&&) noexcept = default;

Hmac::Tag Hmac::of(std::span<const std::span<const std::byte>> pieces) const {
  SHA256_CTX inner = states_->inner;
  for (const std::span<const std::byte> piece : pieces) {
    take_in(inner, piece);
  }
  SHA256_CTX outer = states_->outer;
  take_in(outer, end_of(inner));
  return end_of(outer);
}

std::array<std::byte, kTrailerBytes> MessageSigner::sign(std::string_view channel, std::span<const std::byte> message,
                                                         std::int64_t now_us) {
  std::array<std::byte, kTrailerBytes> trailer{};
  const auto sent_us = static_cast<std::uint64_t>(now_us);
  last_sequence_ = std::max(last_sequence_ + 1, sent_us);
  std::byte* const tag_at = put(put(put(trailer.data(), kMagic), last_sequence_), sent_us);
  const Hmac::Tag tag = tag_of(hmac_, channel, message, std::span(trailer).first(kSignedTrailerBytes));
  std::copy(tag.begin(), tag.end(), tag_at);
  return trailer;
}

Result<std::span<const std::byte>> MessageVerifier::verify(std::string_view channel, std::span<const std::byte> payload,
                                                           std::int64_t now_us) {
  if (payload.size() < kTrailerBytes) {
    return Errc::kMalformed;
  }
  const std::span<const std::byte> message = payload.first(payload.size() - kTrailerBytes);
  const std::span<const std::byte> trailer = payload.last(kTrailerBytes);
  WireReader reader(trailer);
  if (reader.unsigned_number<std::uint32_t>() != kMagic) {
    return Errc::kMalformed;
  }
  const auto sequence = reader.unsigned_number<std::uint64_t>();
  const auto sent_us = reader.int64();
  const Hmac::Tag tag = tag_of(hmac_, channel, message, trailer.first(kSignedTrailerBytes));
  if (CRYPTO_memcmp(tag.data(), reader.rest().data(), tag.size()) != 0) {
    return Errc::kWrongSum;
  }
  if (sequence <= last_sequence_ || sent_us < now_us - kAgeMax_us || sent_us > now_us + kAgeMax_us) {
    return Errc::kTooOld;
  }
  last_sequence_ = sequence;
  return message;
}

std::int64_t wall_clock_us() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec * 1'000'000 + now.tv_nsec / 1000;
}

}  // namespace odoless
