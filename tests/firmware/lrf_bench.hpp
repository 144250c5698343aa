#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/io/file_descriptor.hpp"
#include "drivers/lrf/sick/telegram.hpp"
#include "firmware/sources/lrf_source.hpp"
#include "tests/support/times.hpp"

/// A source of scans with its laser, in made-up time.
namespace odoless::test {

class KeepingSink final : public ScanSink {
 public:
  void on_scan(const RawScan& scan) override {
    ++scans;
    stamps_ns.push_back(scan.stamp_ns);
    first_angle_rad = scan.start_angle_rad;
    last_angle_rad = scan.start_angle_rad + static_cast<double>(scan.ranges_m.size() - 1) * scan.angle_step_rad;
  }
  void on_motion(const Motion& /*motion*/) override {}
  void on_raw(RawLine /*line*/, std::span<const std::byte> /*bytes*/, bool /*to_device*/) override {}
  void on_tilt(const TiltRecord& /*tilt*/) override {}
  void on_event(EventPriority /*priority*/, EventText text, std::int64_t number) override {
    told.push_back(fmt::format(fmt::runtime(fmt::string_view(text)), number));
  }

  [[nodiscard]] long times(std::string_view part) const {
    return std::count_if(told.begin(), told.end(),
                         [&](const std::string& line) { return line.find(part) != std::string::npos; });
  }

  int scans = 0;
  std::vector<std::int64_t> stamps_ns;
  double first_angle_rad = 0.0;  ///< of the last scan
  double last_angle_rad = 0.0;
  std::vector<std::string> told;
};

/// The far end of the line: bytes in, bytes out.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;
  virtual std::string work(std::string_view received, std::int64_t now_ns) = 0;
};

class DeadDevice final : public Device {
 public:
  std::string work(std::string_view /*received*/, std::int64_t /*now_ns*/) override { return ""; }
};

class BabblingDevice final : public Device {
 public:
  std::string work(std::string_view /*received*/, std::int64_t /*now_ns*/) override {
    std::string bytes(20, ' ');
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(rng_.below(256)); });
    return bytes;
  }

 private:
  Rng rng_{3};
};

/// A SICK that takes its time: for each change of its mode 2.9 s, and to write its configuration 14 s, as it may.
class SlowSick final : public Device {
 public:
  std::string work(std::string_view received, std::int64_t now_ns) override {
    if (is_off) {
      return "";
    }
    hear(received, now_ns);
    if (streams_ && now_ns >= next_scan_ns_) {
      sent_ns.push_back(now_ns);
      next_scan_ns_ = now_ns + 500 * kMs;
      waiting_.push_back(
          {now_ns, telegram("\xB0" + std::string("\xB5\x40", 2) + std::string(std::size_t{2} * 181, '\x10'))});
    }
    std::string sent;
    for (; !waiting_.empty() && waiting_.front().at_ns <= now_ns; waiting_.pop_front()) {
      sent += waiting_.front().bytes;
    }
    return sent;
  }

  bool is_off = false;
  int writes = 0;
  std::vector<std::int64_t> sent_ns;  ///< scans

  static std::string telegram(const std::string& payload) {
    const std::size_t size = payload.size() + 1;
    return with_sum(std::string("\x02\x80") + static_cast<char>(size & 0xFFU) + static_cast<char>(size >> 8U) +
                    payload + '\x10');
  }

 private:
  struct Waiting {
    std::int64_t at_ns;
    std::string bytes;
  };

  static std::string with_sum(std::string bytes) {
    const unsigned sum = sick::checksum(std::as_bytes(std::span(bytes.data(), bytes.size())));
    return bytes + static_cast<char>(sum & 0xFFU) + static_cast<char>(sum >> 8U);
  }

  // Requests come whole, one at a time.
  void hear(std::string_view request, std::int64_t now_ns) {
    if (request.size() < 7) {
      return;
    }
    const char command = request[4];
    const bool is_mode = command == '\x20';
    const bool is_stop = is_mode && request[5] == '\x25';
    streams_ = is_mode ? request[5] == '\x24' : streams_;
    if (command == '\x77') {
      ++writes;
      configuration_ = request.substr(5, configuration_.size());
    }
    std::string answer(1, static_cast<char>(command + '\x80'));
    switch (command) {
      case '\x20':
        answer += '\0';
        break;
      case '\x31':
        answer += std::string(151, '\0');
        break;
      case '\x74':
        answer += configuration_;
        break;
      default:
        answer += '\1';
        break;
    }
    const std::int64_t takes_ns = command == '\x77' ? 14 * kSecond : is_mode && !is_stop ? 2900 * kMs : 20 * kMs;
    waiting_.push_back({now_ns + takes_ns, '\x06' + telegram(answer)});
    next_scan_ns_ = now_ns + takes_ns + 100 * kMs;
  }

  std::deque<Waiting> waiting_;
  std::string configuration_ = std::string(34, '\0');
  bool streams_ = false;
  std::int64_t next_scan_ns_ = 0;
};

inline LrfParams sick_params() {
  LrfParams params;
  params.driver = LrfDriver::kSick;
  params.device = "/dev/ttyS0";
  params.baud = 9600;
  params.sick_variant = SickVariant::k180By1;
  return params;
}

/// A source, its laser and who opens the line, in made-up time.
class Bench {
 public:
  explicit Bench(Device& device, const LrfParams& params = sick_params(), int beams_max = 2048)
      : device_(device), source_(params, beams_max, line_) {
    open();
  }
  ~Bench() { const FileDescriptor returned(line_.take_back()); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  void run(std::int64_t duration_ns) {
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += 5 * kMs) {
      source_.work(clock_, heard);
      keep_open();
      work_device();
    }
  }

  /// The time until the line was given back.
  std::int64_t run_until_reopened(std::int64_t at_most_ns) {
    const std::int64_t begin_ns = now_ns_;
    const int before = reopened;
    while (reopened == before && now_ns_ < begin_ns + at_most_ns) {
      run(5 * kMs);
    }
    return now_ns_ - begin_ns;
  }

  [[nodiscard]] std::int64_t rejected() const {
    SourceHealth health;
    source_.add_counts(health);
    return health.rejected;
  }

  /// Each time that the source asks for the time, its thread is held up right after, while the laser goes on.
  void hold_up(std::int64_t duration_ns) { held_up_ns_ = duration_ns; }

  /// The line takes no byte more.
  void fill() {
    const std::string bytes(4096, 'x');
    while (::write(source_.descriptor(), bytes.data(), bytes.size()) > 0) {
    }
    stuck_ = true;
  }

  KeepingSink heard;
  int reopened = 0;

 private:
  void open() {
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0);
    far_end_ = FileDescriptor(ends[1]);
    line_.offer(ends[0]);
  }
  void keep_open() {
    const FileDescriptor returned(line_.take_back());
    if (returned.valid()) {
      ++reopened;
      open();
    }
  }
  void work_device() {
    std::array<char, 4096> bytes{};
    const ssize_t count = stuck_ ? 0 : ::read(far_end_.get(), bytes.data(), bytes.size());
    const std::string sent =
        device_.work({bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))}, now_ns_);
    if (!sent.empty()) {
      EXPECT_EQ(::write(far_end_.get(), sent.data(), sent.size()), static_cast<ssize_t>(sent.size()));
    }
  }

  /// The bench's time.
  class BenchClock final : public Clock {
   public:
    explicit BenchClock(Bench& bench) : bench_(bench) {}
    [[nodiscard]] std::int64_t now_ns() const override {
      const std::int64_t now_ns = bench_.now_ns_;
      bench_.now_ns_ += bench_.held_up_ns_;
      if (bench_.held_up_ns_ > 0) {
        bench_.work_device();
      }
      return now_ns;
    }
    void sleep_until(std::int64_t /*stamp_ns*/) override {}

   private:
    Bench& bench_;
  };

  Device& device_;
  BenchClock clock_{*this};
  std::int64_t held_up_ns_ = 0;
  LineHandover line_;
  LrfSource source_;
  FileDescriptor far_end_;
  std::int64_t now_ns_ = 1000 * kSecond;
  bool stuck_ = false;
};

}  // namespace odoless::test
