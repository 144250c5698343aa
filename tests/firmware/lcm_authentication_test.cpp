#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "firmware/lcm/authentication.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::byte>;

constexpr std::int64_t kNow_us = 1'790'000'000'000'000;

LcmKey key_of(int seed) {
  LcmKey key{};
  std::ranges::generate(key, [value = seed]() mutable { return static_cast<std::byte>(value += 7); });
  return key;
}

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

Bytes sealed(MessageSigner& signer, std::string_view channel, const Bytes& message, std::int64_t now_us = kNow_us) {
  const auto trailer = signer.sign(channel, message, now_us);
  Bytes all = message;
  all.insert(all.end(), trailer.begin(), trailer.end());
  return all;
}

TEST(Hmac, IsThatOfOpenSslForMessagesOfAllLengthsInPieces) {
  for (std::size_t size = 0; size < 300; ++size) {
    const LcmKey key = key_of(static_cast<int>(size));
    const Bytes message(size, static_cast<std::byte>(size));
    Hmac::Tag expected{};
    unsigned int tag_bytes = 0;
    ASSERT_NE(HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
                   reinterpret_cast<const unsigned char*>(message.data()), size,
                   reinterpret_cast<unsigned char*>(expected.data()), &tag_bytes),
              nullptr);
    const std::span<const std::byte> all(message);
    const std::array pieces{all.first(size / 3), all.subspan(size / 3)};
    EXPECT_EQ(Hmac(key).of(pieces), expected) << size;
  }
}

TEST(ParseKey, TakesSixtyFourHexadecimalDigitsAlone) {
  const std::string digits = "000102030405060708090a0b0c0d0e0f101112131415161718191A1B1C1D1E1F";
  LcmKey counted{};
  std::ranges::generate(counted, [value = 0]() mutable { return static_cast<std::byte>(value++); });
  EXPECT_EQ(parse_key(digits), counted);
  EXPECT_EQ(parse_key(digits + "\n"), counted);
  const auto begun = [&](const char* begin) { return begin + digits.substr(std::string_view(begin).size()); };
  for (const std::string& wrong : {std::string(), digits.substr(1), digits + "0", digits + "\n\n", digits + "\r\n",
                                   begun(" "), begun("-1"), begun("0x"), begun("0g"), std::string(64, '\0')}) {
    EXPECT_FALSE(parse_key(wrong)) << wrong;
  }
}

class KeyFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text, mode_t mode) const {
    std::filesystem::path path = folder_.path() / "key";
    std::filesystem::remove(path);
    std::ofstream(path) << text;
    ::chmod(path.c_str(), mode);
    return path;
  }

  test::TemporaryFolder folder_;
  std::string reason_;
};

TEST_F(KeyFile, IsReadWhereOthersMayNot) {
  for (const mode_t mode : {0600U, 0400U, 0640U}) {
    EXPECT_TRUE(read_key(write(std::string(64, 'a') + "\n", mode), reason_).ok()) << reason_;
  }
}

TEST_F(KeyFile, IsRefusedWithWhatWouldBeRight) {
  const auto expect_refused = [&](const std::string& path, const char* why) {
    EXPECT_EQ(read_key(path, reason_).error(), Errc::kBadAddress);
    EXPECT_THAT(reason_, HasSubstr(path));
    EXPECT_THAT(reason_, HasSubstr(why));
    EXPECT_THAT(reason_, HasSubstr("openssl rand -hex 32"));
  };
  expect_refused(write(std::string(64, 'a'), 0644), "all may read it");
  expect_refused(write(std::string(64, 'a'), 0660), "others than its owner may write");
  expect_refused(write("secret", 0600), "something else");
  expect_refused(write(std::string(10'000, 'a'), 0600), "something else");
  expect_refused(folder_.path(), "no file");
  expect_refused("/dev/zero", "no file");
  expect_refused(folder_.path() / "none", "No such file");
}

class Authentication : public ::testing::Test {
 protected:
  Result<std::span<const std::byte>> verify(const Bytes& payload, std::int64_t now_us = kNow_us,
                                            std::string_view channel = "MOTION") {
    return verifier_.verify(channel, payload, now_us);
  }

  const Bytes message_ = bytes_of("a motion of one metre");
  MessageSigner signer_{key_of(1)};
  MessageVerifier verifier_{key_of(1)};
};

TEST_F(Authentication, GivesTheMessageAsItWas) {
  for (const Bytes& message : {message_, Bytes(), Bytes(60'000, std::byte{7})}) {
    const Bytes payload = sealed(signer_, "MOTION", message);
    const auto verified = verify(payload);
    ASSERT_TRUE(verified.ok());
    EXPECT_TRUE(std::ranges::equal(verified.value(), message));
  }
}

TEST_F(Authentication, RefusesEveryOtherByteAndLength) {
  const Bytes payload = sealed(signer_, "MOTION", message_);
  for (std::size_t i = 0; i < payload.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes forged = payload;
      forged[i] ^= static_cast<std::byte>(1U << bit);
      EXPECT_FALSE(verify(forged).ok()) << i;
    }
    EXPECT_FALSE(verify(Bytes(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(i))).ok()) << i;
    EXPECT_FALSE(verify(Bytes(payload.begin() + static_cast<std::ptrdiff_t>(i) + 1, payload.end())).ok()) << i;
  }
  EXPECT_EQ(verify(message_).error(), Errc::kMalformed) << "of who has no key";
  EXPECT_TRUE(verify(payload).ok()) << "what was refused left no trace";
}

TEST_F(Authentication, RefusesAnotherKeyAndAnotherChannel) {
  MessageSigner other(key_of(2));
  EXPECT_EQ(verify(sealed(other, "MOTION", message_)).error(), Errc::kWrongSum);
  EXPECT_EQ(verify(sealed(signer_, "MOTION_AGAIN", message_)).error(), Errc::kWrongSum);
  EXPECT_EQ(verify(sealed(signer_, "MOTIO", bytes_of("Na motion"))).error(), Errc::kWrongSum);
}

TEST_F(Authentication, TakesEachMessageOnceAndInOrder) {
  const Bytes first = sealed(signer_, "MOTION", message_);
  const Bytes second = sealed(signer_, "MOTION", message_);
  const Bytes third = sealed(signer_, "MOTION", message_);
  EXPECT_TRUE(verify(first).ok());
  EXPECT_EQ(verify(first).error(), Errc::kTooOld) << "replayed";
  EXPECT_TRUE(verify(third).ok()) << "the second may be lost";
  EXPECT_EQ(verify(second).error(), Errc::kTooOld) << "out of order";
}

TEST_F(Authentication, RefusesWhatWasNotSentJustNow) {
  const auto sent_ago = [&](std::int64_t age_us) {
    MessageVerifier fresh(key_of(1));  // as after a start: it knows of none before
    return fresh.verify("MOTION", sealed(signer_, "MOTION", message_, kNow_us - age_us), kNow_us).error();
  };
  EXPECT_EQ(sent_ago(MessageVerifier::kAgeMax_us), Errc::kOk);
  EXPECT_EQ(sent_ago(MessageVerifier::kAgeMax_us + 1), Errc::kTooOld);
  EXPECT_EQ(sent_ago(-MessageVerifier::kAgeMax_us), Errc::kOk);
  EXPECT_EQ(sent_ago(-MessageVerifier::kAgeMax_us - 1), Errc::kTooOld);
}

TEST_F(Authentication, FollowsASenderThatStartsAgainAlsoWhenItsClockWasWrong) {
  EXPECT_TRUE(verify(sealed(signer_, "MOTION", message_)).ok());
  MessageSigner again(key_of(1));
  const std::int64_t hour_us = 3'600'000'000;
  EXPECT_EQ(verify(sealed(again, "MOTION", message_, kNow_us - hour_us), kNow_us + 1).error(), Errc::kTooOld);
  EXPECT_TRUE(verify(sealed(again, "MOTION", message_, kNow_us + 2), kNow_us + 2).ok()) << "its clock was set";
  MessageSigner ahead(key_of(1));
  EXPECT_EQ(verify(sealed(ahead, "MOTION", message_, kNow_us + hour_us), kNow_us + 3).error(), Errc::kTooOld);
  EXPECT_TRUE(verify(sealed(again, "MOTION", message_, kNow_us + 4), kNow_us + 4).ok()) << "and did no harm";
}

TEST_F(Authentication, GoesOnWhereTheClocksOfBothAreSetBack) {
  const std::int64_t hour_us = 3'600'000'000;
  EXPECT_TRUE(verify(sealed(signer_, "MOTION", message_)).ok());
  EXPECT_TRUE(verify(sealed(signer_, "MOTION", message_, kNow_us - hour_us), kNow_us - hour_us).ok());
}

TEST_F(Authentication, UsesNoHeap) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer has the heap";
  }
  const Bytes payload = sealed(signer_, "MOTION", Bytes(5000));
  const AllocationGuard guard;
  EXPECT_TRUE(verify(payload).ok());
  EXPECT_FALSE(verify(payload).ok());
  EXPECT_EQ(guard.calls(), 0);
}

}  // namespace
}  // namespace odoless
