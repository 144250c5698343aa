// Rawlogs of MRPT: its serialised objects, one after the other.
#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tools/log/binary_cursor.hpp"
#include "tools/log/binary_stream.hpp"
#include "tools/log/formats/formats.hpp"
#include "tools/log/printable.hpp"

namespace odoless {
namespace {

constexpr std::string_view kScanClass = "CObservation2DRangeScan";
constexpr std::string_view kNamespace = "mrpt::obs::";
constexpr unsigned char kNewHeader = 0x80;  ///< added to the length of a class's name since MRPT 0.5.5
constexpr unsigned char kEndFlag = 0x88;
constexpr std::size_t kClassBytesMax = 120;

/// How an object begins: its class and version, in a form of before or after MRPT 0.5.5.
struct ObjectHead {
  std::string name;
  int version = 0;
  bool is_old = false;
};

bool ends_with_length(std::string_view before, std::size_t length, bool& is_old) {
  using namespace std::string_view_literals;
  is_old = before.ends_with("\0\0\0"sv) && before.size() > 3 &&
           static_cast<unsigned char>(before[before.size() - 4]) == length;
  return is_old || (!before.empty() && static_cast<unsigned char>(before.back()) == (kNewHeader | length));
}

/// Whether the name that stands behind `before` is a class's name.
bool is_header(std::string_view before, bool& is_old) {
  if (before.ends_with(kNamespace)) {
    return ends_with_length(before.substr(0, before.size() - kNamespace.size()), kNamespace.size() + kScanClass.size(),
                            is_old);
  }
  return ends_with_length(before, kScanClass.size(), is_old);
}

/// Of MRPT's clock: units of 100 ns since 1601.
std::int64_t stamp_ns(std::int64_t ticks) {
  constexpr std::int64_t kTicksTo1970 = 116'444'736'000'000'000;
  constexpr std::int64_t kNsPerTick = 100;
  constexpr std::int64_t kMaxTicks = std::numeric_limits<std::int64_t>::max() / kNsPerTick;
  return ticks == 0
             ? 0
             : (std::clamp(ticks, kTicksTo1970 - kMaxTicks, kTicksTo1970 + kMaxTicks) - kTicksTo1970) * kNsPerTick;
}

class Rawlog : public MessageLog {
 public:
  Rawlog(std::unique_ptr<ByteStream> bytes, const std::string& name)
      : MessageLog("MRPT rawlog", name), file_(std::move(bytes), name) {}

 protected:
  bool read(Head& head) override {
    const std::optional<ObjectHead> object = find_scan();
    if (!object) {
      return false;
    }
    scan_ = {};
    label_.clear();
    read_scan(object->version);
    if (!object->is_old) {
      expect_end(kScanClass);
    }
    head.topic = topic_of(label_.empty() ? "(no label)" : label_, kScanClass, true);
    head.recorded_ns = scan_.stamp_ns;
    return true;
  }

  DecodedScan decode() override { return std::move(scan_); }

 private:
  template <class Number>
  Number number() {
    return BinaryCursor(file_.take(sizeof(Number))).number<Number>();
  }

  void expect_end(std::string_view what) {
    if (number<std::uint8_t>() != kEndFlag) {
      file_.fail(fmt::format("the mark of the end of {} is missing", what), "an undamaged rawlog");
    }
  }

  int version(bool is_old) { return is_old ? number<std::int32_t>() : number<std::uint8_t>(); }

  // An object doesn't say how long it is, so that what is no scan can't be stepped over: the next scan's name is looked
  // for instead, with its length before it.
  std::optional<ObjectHead> find_scan() {
    constexpr std::size_t kWindowBytes = 4096;
    const std::size_t kept = kScanClass.size() + kNamespace.size() + sizeof(std::uint32_t);
    while (true) {
      const std::string_view window = file_.peek(kWindowBytes);
      const std::size_t at = window.find(kScanClass);
      if (at == std::string_view::npos) {
        const bool is_last = window.size() < kWindowBytes;
        file_.skip(is_last ? window.size() : window.size() - kept);
        if (is_last) {
          return std::nullopt;
        }
        continue;
      }
      ObjectHead head{.name = std::string(kScanClass)};
      const bool is_found = is_header(window.substr(0, at), head.is_old);
      file_.skip(at + kScanClass.size());
      if (is_found) {
        head.version = version(head.is_old);
        return head;
      }
    }
  }

  ObjectHead read_head() {
    ObjectHead head;
    const auto length = number<std::uint8_t>();
    head.is_old = (length & kNewHeader) == 0;
    const std::size_t name_bytes = length & ~kNewHeader;
    if (name_bytes > kClassBytesMax || (head.is_old && file_.take(3) != std::string_view("\0\0\0", 3))) {
      file_.fail("an object without a class", "an undamaged rawlog");
    }
    head.name = printable(file_.take(name_bytes));
    head.name.erase(0, head.name.rfind(':') + 1);
    head.version = version(head.is_old);
    return head;
  }

  void skip_matrix() {
    const ObjectHead head = read_head();
    const auto rows = number<std::uint32_t>();
    const auto columns = number<std::uint32_t>();
    constexpr std::uint32_t kSizeMax = 64;
    if (!head.name.starts_with("CMatrix") || rows > kSizeMax || columns > kSizeMax) {
      file_.fail(fmt::format("{} of {} by {} where a matrix should be", head.name, rows, columns),
                 "an undamaged rawlog");
    }
    file_.skip(std::uint64_t{rows} * columns * (head.name == "CMatrixD" ? sizeof(double) : sizeof(float)));
    if (!head.is_old) {
      expect_end(head.name);
    }
  }

  void skip_pose() {
    const ObjectHead head = read_head();
    if (head.name != "CPose3D" || head.version > 3) {
      file_.fail(fmt::format("version {} of {} where the laser's pose should be", head.version, head.name),
                 "CPose3D, 0 to 3");
    }
    if (head.version < 2) {
      skip_matrix();
    } else {
      file_.skip(sizeof(double) * (head.version == 2 ? 7 : 12));  // a quaternion, or a matrix, and the place
    }
    if (!head.is_old) {
      expect_end(head.name);
    }
  }

  void read_scan(int version) {
    if (version < 0 || version > 7) {
      file_.fail(fmt::format("version {} of {}", version, kScanClass), "0 to 7");
    }
    const auto aperture_rad = static_cast<double>(number<float>());
    const bool is_counter_clockwise = number<std::uint8_t>() != 0;
    const auto range_max_m = number<float>();
    skip_pose();
    if (version < 6) {
      skip_matrix();  // of the pose's covariance
    }
    const auto ranges = number<std::uint32_t>();
    read_ranges(ranges, version > 0, range_max_m);
    const double sign = is_counter_clockwise ? 1.0 : -1.0;
    scan_.start_angle_rad = -0.5 * sign * aperture_rad;
    scan_.angle_step_rad = sign * aperture_rad / std::max(1.0, static_cast<double>(ranges) - 1.0);
    read_rest(version, ranges);
  }

  void read_ranges(std::uint32_t ranges, bool has_validity, float range_max_m) {
    const std::string_view numbers = file_.take(sizeof(float) * std::uint64_t{ranges});
    BinaryCursor cursor(numbers);
    scan_.ranges_m.resize(ranges);
    std::generate(scan_.ranges_m.begin(), scan_.ranges_m.end(), [&cursor] { return cursor.number<float>(); });
    scan_.no_return_m = range_max_m > 0.0F ? range_max_m : std::numeric_limits<float>::infinity();
    if (has_validity) {
      const std::string_view is_valid = file_.take(ranges);
      for (std::size_t i = 0; i < ranges; ++i) {
        scan_.ranges_m[i] = is_valid[i] != 0 ? scan_.ranges_m[i] : std::numeric_limits<float>::infinity();
      }
    }
  }

  void read_rest(int version, std::uint32_t ranges) {
    file_.skip(version >= 2 ? sizeof(float) : 0);  // error of a range
    scan_.stamp_ns = version >= 3 ? stamp_ns(number<std::int64_t>()) : 0;
    file_.skip(version >= 4 ? sizeof(float) : 0);  // width of a beam
    if (version >= 5) {
      label_ = file_.take(number<std::uint32_t>());
      file_.skip(sizeof(double));  // how much the laser tilts
    }
    if (version >= 7 && number<std::uint8_t>() != 0) {
      file_.skip(sizeof(std::int32_t) * std::uint64_t{ranges});  // intensities
    }
  }

  BinaryStream file_;
  LogScan scan_;
  std::string label_;
};

}  // namespace

bool is_rawlog(std::string_view head) {
  bool is_old = false;
  for (const std::size_t name_at : {std::size_t{1}, sizeof(std::uint32_t)}) {
    const auto length = head.empty() ? std::size_t{0} : static_cast<unsigned char>(head[0]) & ~std::size_t{kNewHeader};
    const std::string_view name = head.substr(std::min(name_at, head.size()), length);
    const bool is_class = name.starts_with("mrpt::") || name.starts_with("C");
    if (length >= 4 && length <= kClassBytesMax && is_class &&
        ends_with_length(head.substr(0, name_at), length, is_old)) {
      return true;
    }
  }
  return false;
}

std::unique_ptr<MessageLog> open_rawlog(std::unique_ptr<ByteStream> bytes, const std::filesystem::path& path) {
  return std::make_unique<Rawlog>(std::move(bytes), path.string());
}

}  // namespace odoless
