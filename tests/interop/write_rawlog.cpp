// Scans (CSV, as `odoless` reads it) to a rawlog, by MRPT itself: write_rawlog SCANS.csv OUT.rawlog
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>

#include "tools/log/scan_log.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    return 64;
  }
  mrpt::io::CFileGZOutputStream file(argv[2]);
  auto archive = mrpt::serialization::archiveFrom(file);
  for (const odoless::LogScan& scan : odoless::read_scan_log(argv[1]).scans) {
    mrpt::obs::CObservation2DRangeScan out;
    out.sensorLabel = "LASER";
    out.timestamp = mrpt::Clock::time_point(mrpt::Clock::duration(scan.stamp_ns / 100 + 116'444'736'000'000'000));
    out.aperture = static_cast<float>(std::abs(scan.angle_step_rad) * static_cast<double>(scan.ranges_m.size() - 1));
    out.rightToLeft = scan.angle_step_rad > 0.0;
    out.maxRange = scan.no_return_m;
    out.resizeScan(scan.ranges_m.size());
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      out.setScanRange(i, scan.ranges_m[i]);
      out.setScanRangeValidity(i, scan.ranges_m[i] < scan.no_return_m);
    }
    mrpt::obs::CObservationOdometry odometry;  // which must not disturb
    odometry.sensorLabel = "ODOMETRY";
    odometry.timestamp = out.timestamp;
    archive << odometry << out;
  }
  return 0;
}
