#include "firmware/lcm/lcm_receiver.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>

#include "firmware/lcm/channels.hpp"
#include "firmware/lcm/datagram.hpp"
#include "firmware/lcm/udp_address.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/private_network.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

using test::kSecond;

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

std::string short_message(std::uint8_t sequence, const std::string& channel, const std::string& payload) {
  return std::string("LC02\0\0\0", 7) + static_cast<char>(sequence) + channel + '\0' + payload;
}

TEST(ParseDatagram, TakesAMessageApart) {
  const std::string datagram = short_message(7, "CHANNEL", "pay\0load");
  const Result<Datagram> parsed = parse_datagram(bytes_of(datagram));
  ASSERT_TRUE(parsed.ok());
  EXPECT_EQ(parsed.value().sequence, 7U);
  EXPECT_EQ(parsed.value().channel, "CHANNEL");
  EXPECT_EQ(text_of(parsed.value().payload), "pay\0load");
}

TEST(ParseDatagram, RefusesAllElse) {
  const auto error_of = [](const std::string& datagram) { return parse_datagram(bytes_of(datagram)).error(); };
  EXPECT_EQ(error_of(""), Errc::kMalformed);
  EXPECT_EQ(error_of("LC02"), Errc::kMalformed);
  EXPECT_EQ(error_of(std::string("LC02\0\0\0\1", 8)), Errc::kMalformed);
  EXPECT_EQ(error_of(std::string("LC02\0\0\0\1CHANNEL", 15)), Errc::kMalformed);
  EXPECT_EQ(error_of(short_message(1, "", "payload")), Errc::kMalformed);
  EXPECT_EQ(error_of(short_message(1, std::string(63, 'c'), "")), Errc::kOk);
  EXPECT_EQ(error_of(short_message(1, std::string(64, 'c'), "")), Errc::kMalformed);
  EXPECT_EQ(error_of("HTTP/1.1 200 OK"), Errc::kMalformed);
  EXPECT_EQ(error_of(std::string("LC03\0\0\0\1", 8) + std::string(100, '\xff')), Errc::kTooLong);
}

TEST(ParseUdpAddress, KnowsLcmsForm) {
  const Result<MulticastAddress> address = parse_udp_address("udpm://239.255.76.67:7667?recv_buf_size=65536");
  ASSERT_TRUE(address.ok());
  EXPECT_EQ(address.value().group, 0xefff4c43U);
  EXPECT_EQ(address.value().port, 7667);
  EXPECT_EQ(address.value().receive_buffer_bytes, 65536);
  for (const char* bad :
       {"", "udpm://", "udpm://239.255.76.67", "udpm://239.255.76.67:0", "udpm://239.255.76.67:65536",
        "udpm://239.255.76.67:76x", "udpm://127.0.0.1:7667", "udpm://239.255.76:7667", "tcpq://239.255.76.67:7667",
        "udpm://239.255.76.67:7667?recv_buf_size=", "udpm://239.255.76.67:7667?speed=1"}) {
    EXPECT_EQ(parse_udp_address(bad).error(), Errc::kBadAddress) << bad;
  }
}

TEST(LossCounter, CountsGapsOfEachSender) {
  LossCounter losses;
  losses.note(1, 100);
  losses.note(2, 7);
  losses.note(1, 101);
  EXPECT_EQ(losses.lost(), 0);
  losses.note(1, 105);
  EXPECT_EQ(losses.lost(), 3);
  losses.note(2, 9);
  EXPECT_EQ(losses.lost(), 4);
}

TEST(LossCounter, TakesBackWhatCameLate) {
  LossCounter losses;
  for (const std::uint32_t sequence : {10U, 12U, 11U, 13U}) {
    losses.note(1, sequence);
  }
  EXPECT_EQ(losses.lost(), 0);
  losses.note(1, 13);  // twice
  EXPECT_EQ(losses.lost(), 0);
}

TEST(LossCounter, KnowsThatNumbersWrapAndSendersStartAgain) {
  LossCounter losses;
  losses.note(1, 0xffffffffU);
  losses.note(1, 1);
  EXPECT_EQ(losses.lost(), 1);
  losses.note(2, 50'000);
  losses.note(2, 0);
  losses.note(2, 1);
  EXPECT_EQ(losses.lost(), 1);
}

TEST(LossCounter, ForgetsTheSenderThatWasSilentForLongest) {
  LossCounter losses;
  for (SenderKey sender = 0; sender <= LossCounter::kSenders; ++sender) {
    losses.note(sender, 0);
  }
  losses.note(LossCounter::kSenders, 2);  // known
  EXPECT_EQ(losses.lost(), 1);
  losses.note(0, 2);  // forgotten
  EXPECT_EQ(losses.lost(), 1);
}

TEST(LcmReceiver, SaysWhyItCannotOpen) {
  LcmParams params;
  params.url = "udpm://127.0.0.1:7667";
  LcmReceiver receiver(params, {});
  EXPECT_EQ(receiver.open(), Errc::kBadAddress);
  EXPECT_THAT(receiver.reason(), HasSubstr("udpm://239.255.76.67:7667"));
  EXPECT_EQ(receiver.descriptor(), -1);
  EXPECT_FALSE(receiver.receive(0));
}

class LcmReceiverNetwork : public ::testing::Test {
 protected:
  void SetUp() override {
    ODOLESS_NEEDS_NETWORK();
    params_.url = test::lcm_url();
    receiver_.emplace(params_, std::vector<std::string>{"WANTED", "ALSO"});
    ASSERT_EQ(receiver_->open(), Errc::kOk) << receiver_->reason();
    sender_ = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in group{};
    group.sin_family = AF_INET;
    group.sin_port = htons(parse_udp_address(params_.url).value().port);
    inet_pton(AF_INET, "239.255.76.67", &group.sin_addr);
    ASSERT_EQ(connect(sender_, reinterpret_cast<const sockaddr*>(&group), sizeof(group)), 0);
  }
  void TearDown() override { close(sender_); }

  void send_bytes(const std::string& datagram) const {
    ASSERT_EQ(::send(sender_, datagram.data(), datagram.size(), 0), static_cast<ssize_t>(datagram.size()));
  }

  LcmParams params_;
  std::optional<LcmReceiver> receiver_;
  int sender_ = -1;
};

// Another process sends by liblcm; each of the messages says how long it is and is filled with its number. It sends the
// next when the one before was heard, as one byte of `heard` says: UDP may drop what a busy host leaves in the socket.
void publish_by_liblcm(const std::string& url, int messages, int heard) {
  lcm_t* lcm = lcm_create((url + "?ttl=0").c_str());
  const auto publish = [lcm](const char* channel, const std::string& data) {
    lcm_publish(lcm, channel, data.data(), static_cast<unsigned int>(data.size()));
  };
  char token = 0;
  for (int i = 0; i < messages; ++i) {
    const std::string data(static_cast<std::size_t>(i * 600), static_cast<char>(i));
    publish("OTHER", data);
    publish(i % 2 == 0 ? "WANTED" : "ALSO", data);
    if (read(heard, &token, 1) != 1) {
      break;  // the test has ended early
    }
  }
  publish("WANTED", std::string(70'000, 'x'));
  publish("WANTED", "end");
  lcm_destroy(lcm);
}

TEST_F(LcmReceiverNetwork, HearsWhatLiblcmSends) {
  constexpr int kMessages = 100;
  std::array<int, 2> heard{};
  ASSERT_EQ(pipe(heard.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(heard[1]);
    publish_by_liblcm(params_.url, kMessages, heard[0]);
    _exit(0);
  }
  close(heard[0]);
  for (int i = 0; i < kMessages; ++i) {
    const std::optional<LcmMessage> message = receiver_->receive(5 * kSecond);
    ASSERT_TRUE(message) << i;
    EXPECT_EQ(message->channel, i % 2 == 0 ? "WANTED" : "ALSO");
    EXPECT_EQ(text_of(message->payload), std::string(static_cast<std::size_t>(i * 600), static_cast<char>(i)));
    ASSERT_EQ(write(heard[1], "", 1), 1);
  }
  const std::optional<LcmMessage> last = receiver_->receive(5 * kSecond);
  ASSERT_TRUE(last);
  EXPECT_EQ(text_of(last->payload), "end");
  EXPECT_EQ(receiver_->counters().messages, kMessages + 1);
  EXPECT_EQ(receiver_->counters().other_channels, kMessages);
  EXPECT_EQ(receiver_->counters().fragments, 2);
  EXPECT_EQ(receiver_->counters().malformed, 0);
  EXPECT_EQ(receiver_->counters().lost, 0);
  close(heard[1]);
  waitpid(child, nullptr, 0);
}

TEST_F(LcmReceiverNetwork, CountsEveryDatagramOnceAndWhatIsMissing) {
  send_bytes(short_message(1, "WANTED", "a"));
  send_bytes("garbage");
  send_bytes("");
  send_bytes(short_message(2, "OTHER", "b"));
  send_bytes(std::string("LC03\0\0\0\3", 8) + std::string(20, '\0'));
  send_bytes(short_message(6, "WANTED", "c"));
  EXPECT_EQ(text_of(receiver_->receive(kSecond)->payload), "a");
  EXPECT_EQ(text_of(receiver_->receive(kSecond)->payload), "c");
  EXPECT_FALSE(receiver_->try_receive());
  const LcmReceiverCounters& counters = receiver_->counters();
  EXPECT_EQ(counters.datagrams, 6);
  EXPECT_EQ(counters.messages, 2);
  EXPECT_EQ(counters.other_channels, 1);
  EXPECT_EQ(counters.fragments, 1);
  EXPECT_EQ(counters.malformed, 2);
  EXPECT_EQ(counters.lost, 2);
  EXPECT_EQ(counters.errors, 0);
}

TEST_F(LcmReceiverNetwork, WaitsAsLongAsItIsToldEvenInAFloodOfOthers) {
  for (int i = 0; i < 100; ++i) {
    send_bytes(short_message(static_cast<std::uint8_t>(i), "OTHER", "x"));
  }
  const auto start = std::chrono::steady_clock::now();
  EXPECT_FALSE(receiver_->receive(kSecond / 20));
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(50));
  EXPECT_FALSE(receiver_->try_receive()) << "what a receiver that was held up has left";
  EXPECT_EQ(receiver_->counters().other_channels, 100);
}

TEST_F(LcmReceiverNetwork, LooksAtABoundedNumberOfDatagramsAtOnce) {
  for (int i = 0; i < LcmReceiver::kDatagramsPerCall; ++i) {
    send_bytes(short_message(static_cast<std::uint8_t>(i), "OTHER", "x"));
  }
  send_bytes(short_message(LcmReceiver::kDatagramsPerCall, "WANTED", "x"));
  EXPECT_FALSE(receiver_->try_receive());
  EXPECT_TRUE(receiver_->receive(5 * kSecond)) << "a busy kernel delivers late";
  EXPECT_EQ(receiver_->counters().other_channels, LcmReceiver::kDatagramsPerCall);
}

// What a socket gets that asks for so much.
int granted_bytes(int wanted_bytes) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  if (setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &wanted_bytes, sizeof(wanted_bytes)) != 0) {
    setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &wanted_bytes, sizeof(wanted_bytes));
  }
  int granted = 0;
  socklen_t size = sizeof(granted);
  getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  close(descriptor);
  return granted;
}

TEST_F(LcmReceiverNetwork, HoldsASecondOfScansThatABusyHostLeavesUnread) {
  constexpr int kScans = 40 * 5;                            // five sendings
  const std::string scan(1081 * sizeof(float) + 150, 'x');  // a planar_lidar_t
  if (granted_bytes(MulticastAddress{}.receive_buffer_bytes) < MulticastAddress{}.receive_buffer_bytes) {
    GTEST_SKIP() << "the kernel grants no socket of " << MulticastAddress{}.receive_buffer_bytes
                 << " bytes: net.core.rmem_max is small and may not be passed";
  }
  for (int i = 0; i < kScans; ++i) {
    send_bytes(short_message(static_cast<std::uint8_t>(i), "WANTED", scan));
  }
  int received = 0;
  while (received < kScans && receiver_->receive(5 * kSecond)) {
    ++received;
  }
  EXPECT_EQ(received, kScans);
  EXPECT_EQ(receiver_->counters().lost, 0);
}

TEST_F(LcmReceiverNetwork, TellsAPollThatAMessageIsHere) {
  pollfd readable{.fd = receiver_->descriptor(), .events = POLLIN, .revents = 0};
  EXPECT_EQ(poll(&readable, 1, 0), 0);
  send_bytes(short_message(1, "WANTED", "a"));
  EXPECT_EQ(poll(&readable, 1, 5000), 1);
}

TEST_F(LcmReceiverNetwork, AllocatesNothing) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer has the heap";
  }
  for (int i = 0; i < 50; ++i) {
    send_bytes(short_message(static_cast<std::uint8_t>(i), i % 2 == 0 ? "WANTED" : "OTHER", std::string(1000, 'x')));
  }
  const AllocationGuard guard;
  int received = 0;
  while (receiver_->receive(kSecond / 100)) {
    ++received;
  }
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_EQ(received, 25);
}

}  // namespace
}  // namespace odoless
