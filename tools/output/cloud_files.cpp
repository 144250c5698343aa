#include "tools/output/cloud_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "tools/command/error.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

static_assert(std::endian::native == std::endian::little, "both formats are written as numbers lie in memory");

template <class Value>
char* put(char* at, const Value& value) {
  std::memcpy(at, &value, sizeof(value));
  return at + sizeof(value);
}

char* put_place(char* at, const Point3& point) {
  return put(at,
             std::array{static_cast<float>(point.x_m), static_cast<float>(point.y_m), static_cast<float>(point.z_m)});
}

/// A header and so many bytes, which are to be filled.
struct Bytes {
  Bytes(const std::string& header, std::size_t size_bytes) : all(header) {
    all.resize(header.size() + size_bytes);
    body = all.data() + header.size();
  }
  std::string all;
  char* body;
};

constexpr std::size_t kPlyPoint_bytes = 15;

std::string ply_header(std::size_t points) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      points);
}

std::uint8_t to_byte(double share) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
}

}  // namespace

HeightColours::HeightColours(std::span<const Point3> points) {
  if (points.empty()) {
    return;
  }
  constexpr std::size_t kLookedAt = 100'000;  // tell the same as all
  std::vector<double> heights_m;
  const std::size_t step = points.size() / kLookedAt + 1;
  for (std::size_t i = 0; i < points.size(); i += step) {
    heights_m.push_back(points[i].z_m);
  }
  std::sort(heights_m.begin(), heights_m.end());
  low_m_ = heights_m[heights_m.size() / 100];
  high_m_ = heights_m[heights_m.size() - 1 - heights_m.size() / 100];
}

Rgb HeightColours::at(double z_m) const {
  const double share = high_m_ > low_m_ ? std::clamp((z_m - low_m_) / (high_m_ - low_m_), 0.0, 1.0) : 0.5;
  const auto hump = [share](double middle) { return 1.5 - 4.0 * std::abs(share - middle); };
  return {to_byte(hump(0.75)), to_byte(hump(0.5)), to_byte(hump(0.25))};
}

std::string cloud_ply(std::span<const Point3> points, const HeightColours& colours) {
  Bytes bytes(ply_header(points.size()), points.size() * kPlyPoint_bytes);
  char* at = bytes.body;
  for (const Point3& point : points) {
    at = put(put_place(at, point), colours.at(point.z_m));
  }
  return std::move(bytes.all);
}

std::string cloud_pcd(std::span<const Point3> points, const HeightColours& colours) {
  constexpr std::size_t kPoint_bytes = 16;
  Bytes bytes(fmt::format("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\n"
                          "TYPE F F F F\nCOUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\n"
                          "DATA binary\n",
                          points.size()),
              points.size() * kPoint_bytes);
  char* at = bytes.body;
  for (const Point3& point : points) {
    const Rgb colour = colours.at(point.z_m);
    const std::uint32_t rgb =
        static_cast<std::uint32_t>(colour.red) << 16U | static_cast<std::uint32_t>(colour.green) << 8U | colour.blue;
    at = put(put_place(at, point), rgb);
  }
  return std::move(bytes.all);
}

std::vector<Point3> read_cloud_ply(const std::filesystem::path& path) {
  const std::string bytes = read_whole_file(path);
  constexpr std::string_view kEnd = "end_header\n";
  const std::size_t end = bytes.find(kEnd);
  const std::size_t body = end == std::string::npos ? bytes.size() : end + kEnd.size();
  const std::size_t count = (bytes.size() - body) / kPlyPoint_bytes;
  if (!bytes.starts_with(ply_header(count)) || bytes.size() != body + count * kPlyPoint_bytes) {
    throw DataError(path.string(), 0, "no cloud, or a part of one", "a PLY file as `odoless cloud` writes it");
  }
  std::vector<Point3> points;
  points.reserve(count);
  for (std::size_t at = body; at < bytes.size(); at += kPlyPoint_bytes) {
    std::array<float, 3> place{};
    std::memcpy(place.data(), bytes.data() + at, sizeof(place));
    points.push_back({place[0], place[1], place[2]});
  }
  return points;
}

void write_cloud_ply(const std::filesystem::path& path, std::span<const Point3> points, const HeightColours& colours) {
  write_whole_file(path, cloud_ply(points, colours));
}

void write_cloud_pcd(const std::filesystem::path& path, std::span<const Point3> points, const HeightColours& colours) {
  write_whole_file(path, cloud_pcd(points, colours));
}

}  // namespace odoless
