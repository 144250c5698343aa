#include "tools/log/event_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr std::uint32_t kEventMagic = 0xEDA1DA01;
constexpr std::int32_t kChannelBytesMax = 1000;

std::uint64_t big_endian(std::span<const char> bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) {
    value = value << 8U | static_cast<unsigned char>(byte);
  }
  return value;
}

}  // namespace

EventLog::EventLog(std::unique_ptr<ByteStream> bytes, std::string name)
    : bytes_(std::move(bytes)), name_(std::move(name)) {}

void EventLog::fail(const std::string& wrong) const {
  throw DataError(name_, 0, wrong, "an LCM log, as lcm-logger and odolessd's recorder (recorder.path) write it");
}

bool EventLog::read(std::span<char> out) {
  while (!out.empty()) {
    const std::size_t got = bytes_->read(out);
    if (got == 0) {
      return false;
    }
    out = out.subspan(got);
    lost_bytes_ += got;
  }
  return true;
}

// In pieces, so that memory follows what is really there.
template <class Bytes>
bool EventLog::read_many(Bytes& out, std::size_t size) {
  constexpr std::size_t kPiece = std::size_t{64} * 1024;
  out.clear();
  std::array<char, kPiece> piece;
  while (out.size() < size) {
    const std::span<char> part = std::span(piece).first(std::min(kPiece, size - out.size()));
    if (!read(part)) {
      return false;
    }
    out.insert(out.end(), part.begin(), part.end());
  }
  return true;
}

bool EventLog::find_message() {
  std::array<char, 4> first{};
  if (!read(first)) {
    return false;
  }
  auto last_four = static_cast<std::uint32_t>(big_endian(first));
  for (std::size_t skipped = 0; last_four != kEventMagic; ++skipped) {
    if (skipped == kSkippedBytesMax) {
      fail(fmt::format("no message in {} bytes", kSkippedBytesMax));
    }
    std::array<char, 1> byte{};
    if (!read(byte)) {
      return false;
    }
    last_four = last_four << 8U | static_cast<unsigned char>(byte[0]);
  }
  return true;
}

bool EventLog::next(LoggedMessage& message) {
  std::array<char, 24> header{};
  if (!find_message() || !read(header)) {
    return false;
  }
  const std::span<const char> fields(header);
  message.number = static_cast<std::int64_t>(big_endian(fields.subspan(0, 8)));
  message.time_us = static_cast<std::int64_t>(big_endian(fields.subspan(8, 8)));
  const auto channel_bytes = static_cast<std::int32_t>(big_endian(fields.subspan(16, 4)));
  const auto data_bytes = static_cast<std::int32_t>(big_endian(fields.subspan(20, 4)));
  if (channel_bytes <= 0 || channel_bytes > kChannelBytesMax || data_bytes < 0 || data_bytes > kDataBytesMax) {
    fail(fmt::format("message {} has a channel of {} bytes and {} bytes of data", message.number, channel_bytes,
                     data_bytes));
  }
  if (!read_many(message.channel, static_cast<std::size_t>(channel_bytes)) ||
      !read_many(message.data, static_cast<std::size_t>(data_bytes))) {
    return false;
  }
  lost_bytes_ -= sizeof(kEventMagic) + header.size() + message.channel.size() + message.data.size();
  return true;
}

}  // namespace odoless
