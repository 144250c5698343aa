#include "firmware/world/world_blobs.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace odoless {
namespace {

static_assert(std::endian::native == std::endian::little, "a world file's bytes are those of the memory");

constexpr std::size_t kStretch = 17;
constexpr std::size_t kPose_bytes = 32;

template <class Values>
std::vector<std::byte> to_bytes(const Values& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {bytes.begin(), bytes.end()};
}

template <std::size_t kCount>
bool to_doubles(std::span<const std::byte> bytes, std::array<double, kCount>& values) {
  if (bytes.size() != sizeof(values)) {
    return false;
  }
  std::memcpy(values.data(), bytes.data(), sizeof(values));
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

Bytef* letters(std::byte* bytes) { return reinterpret_cast<Bytef*>(bytes); }  // NOLINT(*-reinterpret-cast)
const Bytef* letters(const std::byte* bytes) {
  return reinterpret_cast<const Bytef*>(bytes);  // NOLINT(*-reinterpret-cast)
}

}  // namespace

std::vector<std::byte> pack_beams(std::span<const BeamCode> codes) {
  constexpr int kLevel = 6;
  std::vector<std::byte> planes(2 * codes.size());
  BeamCode before = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const auto step = static_cast<BeamCode>(codes[i] - before);
    planes[i] = static_cast<std::byte>(step & 0xffU);
    planes[codes.size() + i] = static_cast<std::byte>(step >> 8U);
    before = codes[i];
  }
  uLongf size = compressBound(planes.size());
  std::vector<std::byte> packed(size);
  if (compress2(letters(packed.data()), &size, letters(planes.data()), planes.size(), kLevel) == Z_OK &&
      size < planes.size()) {
    packed.resize(size);
    return packed;
  }
  return to_bytes(codes);
}

bool unpack_beams(std::span<const std::byte> bytes, std::span<BeamCode> codes) {
  if (codes.empty()) {
    return bytes.empty();
  }
  if (bytes.size() == codes.size_bytes()) {
    std::memcpy(codes.data(), bytes.data(), bytes.size());
    return true;
  }
  std::vector<std::byte> planes(codes.size_bytes());
  uLongf size = planes.size();
  if (uncompress(letters(planes.data()), &size, letters(bytes.data()), bytes.size()) != Z_OK || size != planes.size()) {
    return false;
  }
  BeamCode before = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const unsigned step = std::to_integer<unsigned>(planes[i]) | std::to_integer<unsigned>(planes[codes.size() + i])
                                                                     << 8U;
    before = codes[i] = static_cast<BeamCode>(before + step);
  }
  return true;
}

std::vector<std::byte> pack_stretch(const OdometryStretch& stretch) {
  std::array<double, kStretch> values{stretch.start_T_end.x_m, stretch.start_T_end.y_m, stretch.start_T_end.yaw_rad};
  std::ranges::copy(stretch.covariance, values.begin() + 3);
  const std::array<double, 5> rest{stretch.slip_m.x_m, stretch.slip_m.y_m, stretch.distance_m, stretch.rotation_rad,
                                   stretch.unknown_s};
  std::ranges::copy(rest, values.begin() + 12);
  return to_bytes(values);
}

bool unpack_stretch(std::span<const std::byte> bytes, OdometryStretch& stretch) {
  std::array<double, kStretch> values{};
  if (!to_doubles(bytes, values)) {
    return false;
  }
  stretch.start_T_end = {values[0], values[1], values[2]};
  std::copy_n(values.begin() + 3, stretch.covariance.size(), stretch.covariance.begin());
  stretch.slip_m = {values[12], values[13]};
  stretch.distance_m = values[14];
  stretch.rotation_rad = values[15];
  stretch.unknown_s = values[16];
  return true;
}

std::vector<std::byte> pack_covariance(const Eigen::Matrix3d& covariance) { return to_bytes(rows_of<3>(covariance)); }

bool unpack_covariance(std::span<const std::byte> bytes, Eigen::Matrix3d& covariance) {
  MatrixRows<3> rows{};
  if (!to_doubles(bytes, rows)) {
    return false;
  }
  covariance = matrix_of<3>(rows);
  return true;
}

std::vector<std::byte> pack_poses(std::span<const StampedPose> poses) {
  static_assert(sizeof(StampedPose) == kPose_bytes);
  return to_bytes(poses);
}

bool unpack_poses(std::span<const std::byte> bytes, std::vector<StampedPose>& poses) {
  if (bytes.empty() || bytes.size() % kPose_bytes != 0) {
    return bytes.empty();
  }
  const std::size_t before = poses.size();
  poses.resize(before + bytes.size() / kPose_bytes);
  std::memcpy(poses.data() + before, bytes.data(), bytes.size());
  return std::all_of(poses.begin() + static_cast<std::ptrdiff_t>(before), poses.end(), [](const StampedPose& pose) {
    return std::isfinite(pose.map_T_scan.x_m) && std::isfinite(pose.map_T_scan.y_m) &&
           std::isfinite(pose.map_T_scan.yaw_rad);
  });
}

}  // namespace odoless
