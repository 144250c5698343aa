#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <sys/resource.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include "firmware/lcm/lcm_receiver.hpp"
#include "firmware/lcm/log_writer.hpp"
#include "tests/firmware/lcm_records.hpp"
#include "tests/support/private_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;

struct LoggedEvent {
  std::int64_t number;
  std::int64_t timestamp_us;
  std::string channel;
  std::string data;
};

// As liblcm reads a log.
std::vector<LoggedEvent> events_of(const std::filesystem::path& path) {
  std::vector<LoggedEvent> events;
  lcm_eventlog_t* log = lcm_eventlog_create(path.c_str(), "r");
  if (log == nullptr) {
    ADD_FAILURE() << "cannot open " << path;
    return events;
  }
  while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log)) {
    events.push_back({event->eventnum,
                      event->timestamp,
                      {event->channel, static_cast<std::size_t>(event->channellen)},
                      {static_cast<const char*>(event->data), static_cast<std::size_t>(event->datalen)}});
    lcm_eventlog_free_event(event);
  }
  lcm_eventlog_destroy(log);
  return events;
}

std::vector<std::string> files_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::int64_t bytes_in(const std::filesystem::path& folder) {
  std::int64_t sum_bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    sum_bytes += static_cast<std::int64_t>(entry.file_size());
  }
  return sum_bytes;
}

class LogWriterTest : public ::testing::Test {
 protected:
  LogWriterTest() {
    params_.path = folder_.path() / "run";
    params_.file_max_mb = 1;
    params_.total_max_mb = 3;
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  static void write(LogWriter& writer, const std::string& data, std::int64_t stamp_ns = 5'000'000) {
    writer.record("CHANNEL", std::as_bytes(std::span(data)), stamp_ns);
  }
  // About 100 kB each.
  static void write_many(LogWriter& writer, int events) {
    for (int i = 0; i < events; ++i) {
      write(writer, std::string(100'000, 'x'));
    }
  }

  test::TemporaryFolder folder_;
  LogWriterParams params_;
};

TEST_F(LogWriterTest, WritesWhatLiblcmReads) {
  LogWriter writer(params_);
  const std::string bytes("\0binary\xff", 8);
  write(writer, bytes, 1'700'000'000'123'456'000);
  write(writer, "");
  write(writer, "third");
  EXPECT_TRUE(std::filesystem::exists(file("run.00000.lcm")));
  const std::vector<LoggedEvent> events = events_of(file("run.00000.lcm"));  // still open: what is written can be read
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[0].number, 0);
  EXPECT_EQ(events[0].timestamp_us, 1'700'000'000'123'456);
  EXPECT_EQ(events[0].channel, "CHANNEL");
  EXPECT_EQ(events[0].data, bytes);
  EXPECT_EQ(events[2].number, 2);
  EXPECT_EQ(events[2].data, "third");
  EXPECT_EQ(writer.counters().events, 3);
  EXPECT_EQ(writer.counters().bytes, bytes_in(folder_.path()));
  EXPECT_EQ(writer.counters().errors, 0);
}

TEST_F(LogWriterTest, BeginsTheNextFileWhereOneIsFull) {
  LogWriter writer(params_);
  write_many(writer, 15);
  writer.close();
  EXPECT_THAT(files_in(folder_.path()), ElementsAre("run.00000.lcm", "run.00001.lcm"));
  EXPECT_EQ(events_of(file("run.00000.lcm")).size(), 9U);
  EXPECT_EQ(events_of(file("run.00001.lcm")).size(), 6U);
}

TEST_F(LogWriterTest, KeepsTheNewestWithinTheTotal) {
  LogWriter writer(params_);
  for (int i = 0; i < 100; ++i) {
    write_many(writer, 1);
    ASSERT_LE(bytes_in(folder_.path()), 3'000'000);
  }
  EXPECT_THAT(files_in(folder_.path()), ElementsAre("run.00009.lcm", "run.00010.lcm", "run.00011.lcm"));
  EXPECT_EQ(writer.counters().files_deleted, 9);
  EXPECT_EQ(writer.counters().events, 100);
}

TEST_F(LogWriterTest, GoesOnBehindEarlierRunsAndCountsTheirSize) {
  folder_.file("run.00007.lcm", std::string(2'500'000, 'x'));
  folder_.file("run.12.lcm", "not one of ours");
  folder_.file("other.00009.lcm", "nor this");
  LogWriter writer(params_);
  write(writer, "data");
  EXPECT_THAT(files_in(folder_.path()), ElementsAre("other.00009.lcm", "run.00008.lcm", "run.12.lcm"));
}

TEST_F(LogWriterTest, NeverWritesOverAFile) {
  LogWriter first(params_);
  LogWriter second(params_);
  write(first, "of the first");
  write(second, "of the second");
  EXPECT_EQ(events_of(file("run.00000.lcm")).at(0).data, "of the first");
  EXPECT_EQ(events_of(file("run.00001.lcm")).at(0).data, "of the second");
}

TEST_F(LogWriterTest, GoesOnWhenAFolderAppearsLate) {
  params_.path = folder_.path() / "not_yet" / "run";
  LogWriter writer(params_);
  write(writer, "lost", 1'000'000'000);
  EXPECT_EQ(writer.counters().last_error, ENOENT);
  std::filesystem::create_directory(folder_.path() / "not_yet");
  write(writer, "lost too: too soon to try again", 1'500'000'000);
  write(writer, "kept", 2'000'000'000);
  EXPECT_EQ(writer.counters().errors, 2);
  EXPECT_EQ(events_of(file("not_yet/run.00000.lcm")).at(0).data, "kept");
}

// A limit on the size of files acts as a full disk: the kernel writes a part, then refuses.
TEST_F(LogWriterTest, LeavesOnlyWholeEventsOnAFullDisk) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit unlimited{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
  LogWriter writer(params_);
  write(writer, "before");
  rlimit limited = unlimited;
  limited.rlim_cur = 100;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limited), 0);
  for (int i = 0; i < 5; ++i) {
    write(writer, std::string(1000, 'x'));
  }
  const int errors = static_cast<int>(writer.counters().errors);
  const int last_error = writer.counters().last_error;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
  write(writer, "after");
  EXPECT_EQ(errors, 5);
  EXPECT_EQ(last_error, ENOSPC);
  const std::vector<LoggedEvent> events = events_of(file("run.00000.lcm"));
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].data, "before");
  EXPECT_EQ(events[1].data, "after");
  EXPECT_EQ(events[1].number, 1);
}

TEST_F(LogWriterTest, WithoutAPathWritesNothing) {
  params_.path = "";
  LogWriter writer(params_);
  write(writer, "data");
  EXPECT_EQ(writer.counters().events + writer.counters().errors, 0);
}

TEST_F(LogWriterTest, IsPlayedBackByLcmLogplayer) {
  ODOLESS_NEEDS_NETWORK();
  {
    LogWriter writer(params_);
    LcmParams silent;
    silent.url = "";
    LcmLink link(silent, 100);
    link.set_tap(&writer);
    ScanRecord scan = test::example_scan(100);
    for (int i = 0; i < 20; ++i) {
      scan.stamp_ns += 1'000'000;
      ASSERT_EQ(link.publish(scan, test::example_ranges_m(100)), Errc::kOk);
    }
  }
  LcmParams params;
  params.url = test::lcm_url();
  LcmReceiver receiver(params, {"ODOLESS_SCAN"});
  ASSERT_EQ(receiver.open(), Errc::kOk) << receiver.reason();
  const std::string command =
      "lcm-logplayer --lcm-url='" + params.url + "?ttl=0' " + file("run.00000.lcm").string() + " >/dev/null 2>&1";
  int status = -1;
  std::jthread player([&] { status = std::system(command.c_str()); });
  int received = 0;
  while (received < 20 && receiver.receive(5'000'000'000)) {
    ++received;
  }
  player.join();
  EXPECT_EQ(status, 0);
  EXPECT_EQ(received, 20);
}

}  // namespace
}  // namespace odoless
