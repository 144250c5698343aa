#include "tools/log/formats/laser_scan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/log/binary_cursor.hpp"
#include "tools/log/stamp.hpp"

namespace odoless {
namespace {

constexpr std::size_t kCdrHeaderBytes = 4;
constexpr std::int64_t kNsPerS = 1'000'000'000;

/// What a CDR header may say of the data behind it; where nothing is longer than 32 bits, XCDR2's plain form is
/// XCDR1's.
struct Representation {
  unsigned id = 0;
  std::endian order = std::endian::little;
};
constexpr std::array<Representation, 4> kRepresentations{{
    {0x0000, std::endian::big},
    {0x0001, std::endian::little},
    {0x0006, std::endian::big},
    {0x0007, std::endian::little},
}};

/// The fields from the header's stamp to the intensities.
LogScan read_scan(BinaryCursor& cursor) {
  LogScan scan;
  const auto stamp_s = cursor.number<std::int32_t>();
  const auto stamp_rest_ns = cursor.number<std::uint32_t>();
  scan.stamp_ns = stamp_s * kNsPerS + stamp_rest_ns;
  cursor.text();  // frame_id
  scan.start_angle_rad = cursor.number<float>();
  cursor.number<float>();  // angle_max
  scan.angle_step_rad = cursor.number<float>();
  scan.beam_period_ns = to_beam_period_ns(cursor.number<float>());
  cursor.number<float>();  // scan_time
  const auto range_min_m = cursor.number<float>();
  const auto range_max_m = cursor.number<float>();
  scan.no_return_m = range_max_m > 0.0F ? range_max_m : std::numeric_limits<float>::infinity();
  const auto ranges = cursor.number<std::uint32_t>();
  if (ranges > cursor.rest().size() / sizeof(float)) {
    cursor.bytes(cursor.rest().size() + 1);  // which is not ok
    return scan;
  }
  scan.ranges_m.resize(ranges);
  std::generate(scan.ranges_m.begin(), scan.ranges_m.end(), [&] {
    const auto range_m = cursor.number<float>();
    return range_m < range_min_m ? 0.0F : range_m;
  });
  return scan;
}

void skip_floats(BinaryCursor& cursor) { cursor.bytes(sizeof(float) * std::size_t{cursor.number<std::uint32_t>()}); }

DecodedScan read_to_the_end(BinaryCursor& cursor, std::size_t padding_max_bytes) {
  LogScan scan = read_scan(cursor);
  skip_floats(cursor);
  if (!cursor.ok()) {
    return "the message is shorter than its own counts say";
  }
  if (cursor.rest().size() > padding_max_bytes) {
    return fmt::format("the message goes on for {} bytes behind its last field", cursor.rest().size());
  }
  return scan;
}

DecodedScan decode_cdr(std::string_view message) {
  BinaryCursor header(message, std::endian::big);
  const unsigned id = header.number<std::uint16_t>();
  header.number<std::uint16_t>();  // options
  const auto* const known =
      std::find_if(kRepresentations.begin(), kRepresentations.end(),
                   [id](const Representation& representation) { return representation.id == id; });
  if (!header.ok() || known == kRepresentations.end()) {
    return header.ok() ? fmt::format(
                             "the representation 0x{:04x} of CDR cannot be read, only 0, 1, 6 and 7 can; a bag "
                             "whose messages are compressed is unpacked by `ros2 bag convert`",
                             id)
                       : "the message has no CDR header";
  }
  BinaryCursor cursor(message.substr(kCdrHeaderBytes), known->order, true);
  return read_to_the_end(cursor, sizeof(std::uint32_t) - 1);
}

}  // namespace

bool is_laser_scan(std::string_view type) {
  return type == "sensor_msgs/LaserScan" || type == "sensor_msgs/msg/LaserScan";
}

DecodedScan decode_laser_scan(std::string_view message, RosEncoding encoding) {
  if (encoding == RosEncoding::kCdr) {
    return decode_cdr(message);
  }
  BinaryCursor cursor(message);
  cursor.number<std::uint32_t>();  // the header's sequence number
  return read_to_the_end(cursor, 0);
}

}  // namespace odoless
