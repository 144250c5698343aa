#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/pose3.hpp"
#include "tools/output/canvas.hpp"

namespace odoless {

/// Colours heights from blue (low) over green to red (high).
class HeightColours {
 public:
  /// From the lowest to the highest, leaving out the outermost 1 % of either side.
  explicit HeightColours(std::span<const Point3> points);

  [[nodiscard]] Rgb at(double z_m) const;
  [[nodiscard]] double low_m() const { return low_m_; }
  [[nodiscard]] double high_m() const { return high_m_; }

 private:
  double low_m_ = 0.0;
  double high_m_ = 1.0;
};

/// A cloud, coloured by height, as binary little-endian PLY (x, y, z float, red, green, blue uchar).
[[nodiscard]] std::string cloud_ply(std::span<const Point3> points, const HeightColours& colours);

/// The same as binary PCD 0.7 (x, y, z float, rgb packed in a float as the Point Cloud Library does).
[[nodiscard]] std::string cloud_pcd(std::span<const Point3> points, const HeightColours& colours);

/// The places in such a PLY file. @throws DataError where it is none, or cut; NoInputError, IoError.
[[nodiscard]] std::vector<Point3> read_cloud_ply(const std::filesystem::path& path);

/// Write these files, whole or not at all. @throws CannotCreateError, IoError.
void write_cloud_ply(const std::filesystem::path& path, std::span<const Point3> points, const HeightColours& colours);
void write_cloud_pcd(const std::filesystem::path& path, std::span<const Point3> points, const HeightColours& colours);

}  // namespace odoless
