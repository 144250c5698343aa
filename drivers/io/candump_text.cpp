#include "drivers/io/candump_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace odoless {
namespace {

constexpr std::uint32_t kStandardIdMax = 0x7FF;
constexpr std::size_t kInterfaceMax = 15;  ///< IFNAMSIZ less the end

char* put_id(char* out, const CanFrame& frame) {
  if (frame.is_error()) {
    return fmt::format_to(out, "{:08X}#", frame.id & (CanFrame::kErrorFlag | CanFrame::kErrorMask));
  }
  if ((frame.id & CanFrame::kExtendedFlag) != 0) {
    return fmt::format_to(out, "{:08X}#", frame.id & CanFrame::kErrorMask);
  }
  return fmt::format_to(out, "{:03X}#", frame.id & kStandardIdMax);
}

char* put_data(char* out, const CanFrame& frame) {
  const std::size_t size_bytes = std::min<std::size_t>(frame.size_bytes, frame.data.size());
  if ((frame.id & CanFrame::kRemoteFlag) != 0) {
    return size_bytes == 0 ? fmt::format_to(out, "R") : fmt::format_to(out, "R{}", size_bytes);
  }
  for (std::size_t i = 0; i < size_bytes; ++i) {
    out = fmt::format_to(out, "{:02X}", frame.data[i]);
  }
  return out;
}

}  // namespace

std::string_view candump_text(std::int64_t stamp_us, std::string_view interface, const CanFrame& frame,
                              std::span<char, kCandumpTextMax> buffer) {
  const std::int64_t time_us = std::max<std::int64_t>(stamp_us, 0);
  char* end = fmt::format_to(buffer.data(), "({:010}.{:06}) {} ", time_us / 1'000'000, time_us % 1'000'000,
                             interface.substr(0, kInterfaceMax));
  end = put_data(put_id(end, frame), frame);
  return {buffer.data(), static_cast<std::size_t>(end - buffer.data())};
}

}  // namespace odoless
