#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <map>
#include <memory>

#include "drivers/io/file_descriptor.hpp"
#include "firmware/health/health_text.hpp"
#include "firmware/lcm/datagram.hpp"
#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/log_writer.hpp"
#include "firmware/publisher/publisher.hpp"
#include "firmware/sources/lcm_source.hpp"
#include "tests/firmware/lcm_records.hpp"
#include "tests/keys/key_class.hpp"
#include "tests/keys/transcript.hpp"
#include "tests/support/private_network.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/times.hpp"

namespace {

int times_synchronised = 0;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

}  // namespace

// Instead of the C library's: only so can be seen when files are handed to the disk.
extern "C" int fdatasync(int descriptor) {
  ++times_synchronised;
  return ::fsync(descriptor);
}

namespace odoless::test {
namespace {

using test::kMs;
using test::kSecond;
constexpr int kPublishedBeams = 40;

/// Datagrams of LCM as they come, and through how many routers they might have gone.
class Listener {
 public:
  explicit Listener(int port) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    const int on = 1;
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    ::setsockopt(socket_.get(), IPPROTO_IP, IP_RECVTTL, &on, sizeof(on));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_ANY);
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    ip_mreq group{};
    group.imr_multiaddr.s_addr = inet_addr("239.255.76.67");
    EXPECT_EQ(::setsockopt(socket_.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof(group)), 0);
  }

  [[nodiscard]] std::string heard() {
    std::string text;
    std::array<std::byte, 65536> bytes{};
    std::array<char, CMSG_SPACE(sizeof(int))> control{};
    for (;;) {
      iovec piece{bytes.data(), bytes.size()};
      msghdr message{};
      message.msg_iov = &piece;
      message.msg_iovlen = 1;
      message.msg_control = control.data();
      message.msg_controllen = control.size();
      const ssize_t size = ::recvmsg(socket_.get(), &message, 0);
      if (size < 0) {
        return text;
      }
      const auto datagram = parse_datagram(std::span(bytes).first(static_cast<std::size_t>(size)));
      const cmsghdr* const ttl = CMSG_FIRSTHDR(&message);
      text += fmt::format("{} {} bytes, ttl {}\n", datagram.ok() ? datagram.value().channel : "piece", size,
                          ttl == nullptr ? -1 : *reinterpret_cast<const int*>(CMSG_DATA(ttl)));
    }
  }

 private:
  FileDescriptor socket_;
};

int port_of(const std::string& url) { return std::stoi(url.substr(url.rfind(':') + 1)); }

/// What goes over the network.
std::string sent(int port, const DaemonParams& params) {
  Listener listener(port);
  LcmLink link(params.lcm, 10'000);
  if (link.open() != Errc::kOk) {
    return link.reason();
  }
  link.send_again();
  const std::vector<float> ranges_m = example_ranges_m(kPublishedBeams);
  const std::vector<std::byte> raw(3);
  for (int i = 0; i < 4; ++i) {
    static_cast<void>(link.publish(example_scan(kPublishedBeams), ranges_m));
    static_cast<void>(link.publish(example_motion()));
    static_cast<void>(link.publish(example_pose()));
  }
  static_cast<void>(link.publish_points(example_pose(), example_scan(kPublishedBeams), ranges_m));
  static_cast<void>(link.publish(RawBytesRecord{.stamp_ns = 5000, .size_bytes = 3}, raw));
  return listener.heard();
}

/// What a daemon without a laser of its own takes for scans.
std::string taken(const DaemonParams& params) {
  LcmSource source(params.lcm, params.lrf.channel, 1081);
  if (source.open() != Errc::kOk) {
    return source.reason();
  }
  LcmLink link(params.lcm, 10'000);
  EXPECT_EQ(link.open(), Errc::kOk) << link.reason();
  static_cast<void>(link.publish(example_scan(kPublishedBeams), example_ranges_m(kPublishedBeams)));
  Transcript heard;
  source.work(ManualClock(kSecond), heard);
  return heard.text();
}

std::string files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::uintmax_t> sizes;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    sizes[entry.path().filename()] = entry.file_size();
  }
  std::string text;
  for (const auto& [name, size] : sizes) {
    text += fmt::format("{} {}\n", name, size);
  }
  return text;
}

void empty(const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
}

/// Six megabytes in six seconds.
std::string recorded(const std::filesystem::path& folder, const DaemonParams& params) {
  empty(folder);
  times_synchronised = 0;
  {
    LogWriter writer(params.recorder);
    const std::vector<std::byte> message(100'000);
    for (int i = 0; i < 60; ++i) {
      writer.record("KEYS", message, i * kSecond / 10);
    }
  }
  return files_in(folder) + fmt::format("{} times safe\n", times_synchronised);
}

/// How often each channel is in the recorder's files.
std::string channels_in(const std::filesystem::path& folder) {
  constexpr std::size_t kHeader_bytes = 28;
  std::map<std::string, int> counts;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string log = content_of(entry.path());
    const auto number = [&](std::size_t at) {
      std::size_t value = 0;
      for (std::size_t i = at; i < at + 4; ++i) {
        value = value << 8U | static_cast<unsigned char>(log[i]);
      }
      return value;
    };
    for (std::size_t at = 0; at + kHeader_bytes <= log.size();
         at += kHeader_bytes + number(at + 20) + number(at + 24)) {
      ++counts[log.substr(at + kHeader_bytes, number(at + 20))];
    }
  }
  std::string text;
  for (const auto& [channel, count] : counts) {
    text += fmt::format("{} {}\n", channel, count);
  }
  return text;
}

/// A publisher and what the stages tell it in 8 s: a laser that falls silent for a while, poor matches, a missed
/// deadline, a map that changes.
std::string published(const std::filesystem::path& folder, const DaemonParams& params) {
  empty(folder);
  std::string text;
  {
    Pipeline pipeline(params.pipeline, params.robot, false);
    const GridGeometry geometry{.resolution_m = 0.1, .columns = 64, .rows = 64};
    Publisher publisher({params.lcm, params.recorder, params.health, {}, {}}, geometry, pipeline, "");
    SensorReport sensor;
    sensor.period_ns = 100 * kMs;
    sensor.open = true;
    MatcherReport matcher;
    matcher.weak_information_1_m2 = 20.0;
    matcher.stage.scans = 2;
    FilterReport filter;
    filter.stage.scans = 1;
    for (std::int64_t now_ns = 1000 * kSecond; now_ns < 1008 * kSecond; now_ns += 50 * kMs) {
      const std::int64_t since_ns = now_ns - 1000 * kSecond;
      const bool silent = since_ns > 2 * kSecond && since_ns < 4 * kSecond;
      sensor.last_scan_ns = silent ? sensor.last_scan_ns : now_ns;
      matcher.poor_in_a_row = since_ns > 5 * kSecond && since_ns < 6 * kSecond ? 4 : 0;
      matcher.stage.deadline_misses = since_ns > 6 * kSecond ? 1 : 0;
      pipeline.sensor.report.write(sensor);
      pipeline.matcher.report.write(matcher);
      pipeline.filter.report.write(filter);
      const std::vector<std::uint8_t> cells(16);
      static_cast<void>(pipeline.filter.outbox.send(
          RecordType::kMapTile, MapTileRecord{.size_cells = 4, .cell_size_m = 0.1}, std::span(cells)));
      publisher.round(now_ns);
      text += fmt::format("{} {}\n", name_of(publisher.health().state), reasons_text(publisher.health().reasons));
    }
  }
  return text + channels_in(folder);
}

std::string in_folder(const std::filesystem::path& folder, const std::string& more) {
  return fmt::format("[recorder]\npath = \"{}\"\n{}[lcm]\nurl = \"\"\n[scan]\nbeams_max = 64\n",
                     (folder / "log").string(), more);
}

std::vector<Scene> network_scenes() {
  const std::string url = lcm_url();
  const int port = port_of(url);
  const std::string lcm = fmt::format("[lcm]\nurl = \"{}\"\n", url);
  return {{"sent", {lcm}, [port](const DaemonParams& params) { return sent(port, params); }},
          {"taken", {lcm + "[lrf]\ndriver = \"lcm\"\nchannel = \"ODOLESS_SCAN\"\n"}, taken}};
}

std::vector<Scene> recorder_scenes() {
  const auto folder = std::make_shared<TemporaryFolder>();
  const std::filesystem::path log = folder->path() / "log";
  return {{"recorded",
           {in_folder(log, "file_max_mb = 1\ntotal_max_mb = 3\n")},
           [folder, log](const DaemonParams& params) { return recorded(log, params); }}};
}

std::vector<Scene> health_scenes() {
  const auto folder = std::make_shared<TemporaryFolder>();
  const std::filesystem::path log = folder->path() / "log";
  return {{"published", {in_folder(log, "")}, [folder, log](const DaemonParams& params) {
             return published(log, params);
           }}};
}

}  // namespace

std::vector<KeyClass> publisher_classes() {
  return {{"network", {"lcm.", "lrf.channel"}, network_scenes, enter_private_network},
          {"recorder", {"recorder."}, recorder_scenes},
          {"health", {"health.", "lcm.overview"}, health_scenes}};
}

}  // namespace odoless::test
