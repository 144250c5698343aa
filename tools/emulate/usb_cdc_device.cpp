#include "tools/emulate/usb_cdc_device.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace odoless {
namespace {

constexpr std::size_t kHeaderBytes = 48;
constexpr std::size_t kPacketBytes = 64;
constexpr std::size_t kToHostMaxBytes = 16384;
constexpr std::uint32_t kSubmit = 1;
constexpr std::uint32_t kUnlink = 2;
constexpr std::uint32_t kSubmitReply = 3;
constexpr std::uint32_t kUnlinkReply = 4;
constexpr std::int32_t kStall = -32;      // EPIPE
constexpr std::int32_t kUnlinked = -104;  // ECONNRESET
constexpr std::uint32_t kTransferMaxBytes = 1U << 20;

std::uint32_t big_endian(std::string_view bytes, std::size_t offset) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number = number << 8 | static_cast<unsigned char>(bytes[offset + i]);
  }
  return number;
}

void put_big_endian(std::string& out, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    out += static_cast<char>(number >> shift & 0xff);
  }
}

std::string bytes_of(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) {
    bytes += static_cast<char>(value);
  }
  return bytes;
}

std::string text_descriptor(std::string_view text) {
  std::string bytes = bytes_of({static_cast<int>(2 * text.size() + 2), 3});
  for (const char character : text) {
    bytes += character;
    bytes += '\0';
  }
  return bytes;
}

/// USB 2.0, 9.6.3, with the functional descriptors of CDC 1.2, 5.2.3 and PSTN 1.2, 5.3.
std::string configuration_descriptor() {
  const std::string interfaces = bytes_of({9,  4,    0,    0,    1,
                                           2,  2,    1,    0,        // control: CDC, ACM
                                           5,  0x24, 0,    0x10, 1,  // header
                                           5,  0x24, 1,    0,    1,  // call management
                                           4,  0x24, 2,    2,        // ACM: line coding and state
                                           5,  0x24, 6,    0,    1,  // union
                                           7,  5,    0x81, 3,    16,
                                           0,  10,  // notifications
                                           9,  4,    1,    0,    2,
                                           10, 0,    0,    0,  // data
                                           7,  5,    0x82, 2,    kPacketBytes,
                                           0,  0,  // to the host
                                           7,  5,    0x02, 2,    kPacketBytes,
                                           0,  0});  // from the host
  return bytes_of({9, 2, static_cast<int>(9 + interfaces.size()), 0, 2, 1, 0, 0x80, 50}) + interfaces;
}

}  // namespace

void UsbCdcDevice::receive(std::string_view bytes) {
  input_ += bytes;
  while (take_packet()) {
  }
  serve_reads();
}

std::string UsbCdcDevice::take_output() { return std::exchange(output_, {}); }

std::string UsbCdcDevice::take_received() { return std::exchange(from_host_, {}); }

std::size_t UsbCdcDevice::send(std::string_view bytes) {
  const std::size_t size_bytes = std::min(bytes.size(), kToHostMaxBytes - std::min(to_host_.size(), kToHostMaxBytes));
  to_host_ += bytes.substr(0, size_bytes);
  serve_reads();
  return size_bytes;
}

bool UsbCdcDevice::take_packet() {
  if (input_.size() < kHeaderBytes) {
    return false;
  }
  const std::uint32_t command = big_endian(input_, 0);
  const bool is_out = big_endian(input_, 12) == 0;
  const std::uint32_t size_bytes = command == kSubmit && is_out ? big_endian(input_, 24) : 0;
  if (size_bytes > kTransferMaxBytes || (command != kSubmit && command != kUnlink)) {
    input_.clear();  // not USB/IP: there is no way to find the next packet
    return false;
  }
  if (input_.size() < kHeaderBytes + size_bytes) {
    return false;
  }
  const std::string packet = input_.substr(0, kHeaderBytes + size_bytes);
  input_.erase(0, packet.size());
  if (command == kSubmit) {
    submit(std::string_view(packet).substr(0, kHeaderBytes), std::string_view(packet).substr(kHeaderBytes));
  } else {
    unlink(big_endian(packet, 4), big_endian(packet, 20));
  }
  return true;
}

void UsbCdcDevice::submit(std::string_view header, std::string_view data) {
  const std::uint32_t sequence = big_endian(header, 4);
  const bool is_out = big_endian(header, 12) == 0;
  const std::uint32_t endpoint = big_endian(header, 16);
  const std::size_t size_bytes = std::min(big_endian(header, 24), kTransferMaxBytes);
  if (endpoint == 0) {
    control(sequence, header.substr(40), data, size_bytes);
  } else if (is_out) {
    from_host_ += data;
    reply(sequence, 0, data.size(), {});
  } else if (endpoint == 1) {
    notifications_.push_back(sequence);
  } else {
    reads_.push_back({.sequence = sequence, .size_bytes = size_bytes});
  }
}

void UsbCdcDevice::unlink(std::uint32_t sequence, std::uint32_t victim) {
  const std::size_t removed = std::erase_if(reads_, [&](const Request& read) { return read.sequence == victim; }) +
                              std::erase(notifications_, victim);
  put_big_endian(output_, kUnlinkReply);
  put_big_endian(output_, sequence);
  output_.append(12, '\0');
  put_big_endian(output_, static_cast<std::uint32_t>(removed > 0 ? kUnlinked : 0));
  output_.append(24, '\0');
}

// USB 2.0, 9.4, and PSTN 1.2, 6.3: the first two bytes of a set-up say what is asked.
void UsbCdcDevice::control(std::uint32_t sequence, std::string_view setup, std::string_view data,
                           std::size_t size_bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(setup[i]); };
  const bool is_in = (byte(0) & 0x80) != 0;
  std::string answer;
  if (byte(0) == 0x80 && byte(1) == 6) {
    answer = descriptor(byte(3), byte(2));
    if (answer.empty()) {
      return reply(sequence, kStall, 0, {});
    }
  } else if (is_in && byte(1) == 0) {
    answer = std::string(2, '\0');
  } else if (byte(0) == 0xa1 && byte(1) == 0x21) {
    answer = line_coding_;
  } else if (byte(0) == 0x21 && byte(1) == 0x20) {
    line_coding_ = data;
  } else if (byte(0) == 0x21 && byte(1) == 0x22) {
    open_ = (byte(2) & 1) != 0;
    to_host_.clear();
  }
  answer.resize(std::min(answer.size(), size_bytes));
  reply(sequence, 0, is_in ? answer.size() : data.size(), answer);
}

std::string UsbCdcDevice::descriptor(int type, int index) const {
  const auto low = [](std::uint16_t number) { return number & 0xff; };
  switch (type) {
    case 1:
      return bytes_of({18, 1, 0x00, 2, 2, 0, 0, kPacketBytes, low(identity_.vendor), identity_.vendor >> 8,
                       low(identity_.product), identity_.product >> 8, 0, 1, 1, 2, 3, 1});
    case 2:
      return configuration_descriptor();
    case 3: {
      const std::array<const std::string*, 3> texts{&identity_.manufacturer, &identity_.product_text,
                                                    &identity_.serial};
      if (index == 0) {
        return bytes_of({4, 3, 0x09, 0x04});
      }
      return index <= 3 ? text_descriptor(*texts.at(static_cast<std::size_t>(index - 1))) : "";
    }
    default:
      return {};
  }
}

void UsbCdcDevice::reply(std::uint32_t sequence, std::int32_t status, std::size_t actual_bytes, std::string_view data) {
  put_big_endian(output_, kSubmitReply);
  put_big_endian(output_, sequence);
  output_.append(12, '\0');
  put_big_endian(output_, static_cast<std::uint32_t>(status));
  put_big_endian(output_, static_cast<std::uint32_t>(actual_bytes));
  output_.append(20, '\0');
  output_ += data;
}

void UsbCdcDevice::serve_reads() {
  while (!reads_.empty() && !to_host_.empty()) {
    const Request read = reads_.front();
    reads_.pop_front();
    const std::string data = to_host_.substr(0, read.size_bytes);
    to_host_.erase(0, data.size());
    reply(read.sequence, 0, data.size(), data);
  }
}

}  // namespace odoless
