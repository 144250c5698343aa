#include "firmware/lcm/log_writer.hpp"

#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

namespace odoless {
namespace {

constexpr std::uint32_t kEventMagic = 0xEDA1DA01;
constexpr std::int64_t kBytesPerMb = 1'000'000;
constexpr std::int64_t kRetryNs =
    1'000'000'000;  // after a refused file; a directory that is missing won't be there sooner
constexpr std::string_view kExtension = ".lcm";
constexpr std::size_t kNumberDigits = 5;
constexpr int kNumbersTried = 100;

template <std::size_t Bytes>
std::byte* put(std::byte* out, std::uint64_t value) {
  for (std::size_t i = 0; i < Bytes; ++i) {
    *out++ = static_cast<std::byte>(value >> (8 * (Bytes - 1 - i)));
  }
  return out;
}

// The number in NAME.00012.lcm, or -1.
int number_of(std::string_view file, std::string_view name) {
  if (file.size() <= name.size() + 1 + kExtension.size() || !file.starts_with(name) || file[name.size()] != '.' ||
      !file.ends_with(kExtension)) {
    return -1;
  }
  const std::string_view digits = file.substr(name.size() + 1, file.size() - name.size() - 1 - kExtension.size());
  int number = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool whole = error == std::errc{} && end == digits.data() + digits.size() && digits.size() >= kNumberDigits;
  return whole && number >= 0 ? number : -1;
}

std::string numbered(const std::string& path, int number) {
  std::string digits = std::to_string(number);
  digits.insert(0, kNumberDigits - std::min(kNumberDigits, digits.size()), '0');
  return path + '.' + digits + std::string(kExtension);
}

}  // namespace

LogWriter::LogWriter(LogWriterParams params) : params_(std::move(params)) {
  if (!params_.path.empty()) {
    find_earlier_files();
  }
}

LogWriter::~LogWriter() { close(); }

void LogWriter::find_earlier_files() {
  const std::filesystem::path path(params_.path);
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::vector<int> numbers;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (const int number = number_of(entry->path().filename().string(), path.filename().string()); number >= 0) {
      numbers.push_back(number);
    }
  }
  std::sort(numbers.begin(), numbers.end());
  for (const int number : numbers) {
    std::string file = numbered(params_.path, number);
    const auto size_bytes = std::filesystem::file_size(file, error);
    files_.push_back({std::move(file), error ? 0 : static_cast<std::int64_t>(size_bytes)});
    next_number_ = number + 1;
  }
}

void LogWriter::count_error() {
  counters_.last_error = errno;
  ++counters_.errors;
}

void LogWriter::record(std::string_view channel, std::span<const std::byte> message, std::int64_t stamp_ns) {
  if (params_.path.empty()) {
    return;
  }
  const std::size_t event_bytes = kHeaderBytes + channel.size() + message.size();
  if (!make_room(static_cast<std::int64_t>(event_bytes), stamp_ns)) {
    return;
  }
  std::array<std::byte, kHeaderBytes> header;
  std::byte* out = put<4>(header.data(), kEventMagic);
  out = put<8>(out, static_cast<std::uint64_t>(event_number_));
  out = put<8>(out, static_cast<std::uint64_t>(stamp_ns / 1000));
  out = put<4>(out, channel.size());
  put<4>(out, message.size());
  append(header, channel, message);
  synchronise(stamp_ns);
}

bool LogWriter::make_room(std::int64_t event_bytes, std::int64_t stamp_ns) {
  if (descriptor_ >= 0 && files_.back().size_bytes + event_bytes > params_.file_max_mb * kBytesPerMb) {
    close();
  }
  if (descriptor_ >= 0) {
    return true;
  }
  if (refused_ && std::abs(stamp_ns - refused_stamp_ns_) < kRetryNs) {
    ++counters_.errors;  // the errno is still that of the refusal
    return false;
  }
  refused_ = !open_next();
  refused_stamp_ns_ = stamp_ns;
  synchronised_stamp_ns_ = stamp_ns;
  return !refused_;
}

bool LogWriter::open_next() {
  const auto total_bytes = [this] {
    std::int64_t sum_bytes = 0;
    for (const File& file : files_) {
      sum_bytes += file.size_bytes;
    }
    return sum_bytes;
  };
  const std::int64_t room_bytes = std::max<std::int64_t>(0, params_.total_max_mb - params_.file_max_mb) * kBytesPerMb;
  while (!files_.empty() && total_bytes() > room_bytes) {
    delete_oldest();
  }
  for (int attempt = 0; attempt < kNumbersTried; ++attempt) {
    std::string path = numbered(params_.path, next_number_);
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (descriptor_ >= 0) {
      ++next_number_;
      ++counters_.files_opened;
      files_.push_back({std::move(path), 0});
      event_number_ = 0;
      return true;
    }
    if (errno != EEXIST) {
      break;
    }
    ++next_number_;
  }
  count_error();
  return false;
}

void LogWriter::delete_oldest() {
  if (::unlink(files_.front().path.c_str()) == 0) {
    ++counters_.files_deleted;
  } else {
    count_error();
  }
  files_.pop_front();
}

void LogWriter::append(std::span<const std::byte> header, std::string_view channel,
                       std::span<const std::byte> message) {
  // writev only reads, but its type cannot say so.
  const auto piece = [](const void* data, std::size_t size_bytes) {
    return iovec{const_cast<void*>(data), size_bytes};  // NOLINT(cppcoreguidelines-pro-type-const-cast): as above
  };
  const std::array<iovec, 3> pieces{piece(header.data(), header.size()), piece(channel.data(), channel.size()),
                                    piece(message.data(), message.size())};
  const auto event_bytes = static_cast<ssize_t>(header.size() + channel.size() + message.size());
  const ssize_t written_bytes = ::writev(descriptor_, pieces.data(), static_cast<int>(pieces.size()));
  if (written_bytes == event_bytes) {
    files_.back().size_bytes += event_bytes;
    counters_.bytes += event_bytes;
    ++counters_.events;
    ++event_number_;
    return;
  }
  if (written_bytes >= 0) {
    errno = ENOSPC;  // what else cuts a write to a file short
  }
  count_error();
  const off_t end_bytes = files_.back().size_bytes;
  if (::ftruncate(descriptor_, end_bytes) != 0 || ::lseek(descriptor_, end_bytes, SEEK_SET) != end_bytes) {
    close();  // half an event may stand at its end; readers skip that
  }
}

void LogWriter::synchronise(std::int64_t stamp_ns) {
  if (descriptor_ < 0 || std::abs(static_cast<double>(stamp_ns - synchronised_stamp_ns_)) < params_.sync_s * 1e9) {
    return;
  }
  synchronised_stamp_ns_ = stamp_ns;
  if (::fdatasync(descriptor_) != 0) {
    count_error();
  }
}

void LogWriter::close() {
  if (descriptor_ < 0) {
    return;
  }
  if (::fdatasync(descriptor_) != 0) {
    count_error();
  }
  if (::close(descriptor_) != 0) {
    count_error();
  }
  descriptor_ = -1;
}

}  // namespace odoless
