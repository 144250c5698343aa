// The drivers of MRPT (Debian's libmrpt-hwdrivers) read scans from our emulated lasers, each on a pseudo-terminal.
#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/hwdrivers/CHokuyoURG.h>
#include <mrpt/hwdrivers/CRoboPeakLidar.h>
#include <mrpt/hwdrivers/CSickLaserSerial.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/command_process.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/sim/ray_caster.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

constexpr const char* kWorld = "room 0 0  8 5\nbox 6 3  1 0.6\nspeed 0.01\ngo 3 2  3.01 2\n";
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

void wait_for(const std::string& path) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!std::filesystem::exists(path) && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

/// As their users do: again where a busy machine was too slow for the client's patience. (Some clients have it
/// private.)
void initialize(mrpt::hwdrivers::CGenericSensor& client) {
  constexpr int kTries = 5;
  for (int i = 1; i < kTries; ++i) {
    try {
      return client.initialize();
    } catch (const std::exception&) {
    }
  }
  client.initialize();
}

/// The scan that a client has after a while, or none.
template <class Client>
mrpt::obs::CObservation2DRangeScan scan_of(Client& client, int scans) {
  mrpt::obs::CObservation2DRangeScan scan;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (scans > 0 && std::chrono::steady_clock::now() < end) {
    bool there_is = false;
    bool is_broken = false;
    mrpt::obs::CObservation2DRangeScan next;
    client.doProcessSimple(there_is, next, is_broken);
    if (there_is) {
      scan = next;
      --scans;
    }
  }
  EXPECT_EQ(scans, 0) << "no scans within 30 s";
  return scan;
}

/// Share of the beams, from `first_deg` on, counter-clockwise where the step is positive, that see the world as it is.
double right_share(const mrpt::obs::CObservation2DRangeScan& scan, double first_deg, double step_deg, double far_m) {
  const World world = parse_world(kWorld, "room");
  int right = 0;
  for (std::size_t i = 0; i < scan.getScanSize(); ++i) {
    const double angle_rad = (first_deg + step_deg * static_cast<double>(i)) * kRadPerDeg;
    const double true_m = cast_ray_m(world, {3.0, 2.0}, {std::cos(angle_rad), std::sin(angle_rad)});
    const bool sees = scan.getScanRangeValidity(i) && std::abs(scan.getScanRange(i) - true_m) < 0.03;
    right += sees || (true_m > far_m && !scan.getScanRangeValidity(i)) ? 1 : 0;
  }
  return right / static_cast<double>(std::max<std::size_t>(scan.getScanSize(), 1));
}

class Mrpt : public ::testing::Test {
 protected:
  /// Starts the laser and gives the client its configuration.
  template <class Client>
  void connect(Client& client, const std::string& model, const std::string& settings) {
    if (emulator_) {
      emulator_->stop(SIGTERM);  // which takes its link away
    }
    emulator_.emplace(std::vector<std::string>{"emulate", "lrf", "--from", folder_.file("a.world", kWorld), "--pty",
                                               pty_, "--model", model, "--noise-sd-m", "0"});
    wait_for(pty_);
    client.loadConfig(mrpt::config::CConfigFileMemory("[laser]\nCOM_port_LIN = " + pty_ + "\n" + settings +
                                                      "pose_x = 0\npose_y = 0\npose_z = 0\npose_yaw = 0\n"
                                                      "pose_pitch = 0\npose_roll = 0\n"),
                      "laser");
  }

  test::TemporaryFolder folder_;
  std::string pty_ = folder_.path() / "laser";
  std::optional<test::CommandProcess> emulator_;
};

TEST_F(Mrpt, ReadsAHokuyoUtm) {
  mrpt::hwdrivers::CHokuyoURG client;
  connect(client, "utm-30lx", "HOKUYO_motorSpeed_rpm = 0\n");
  initialize(client);
  const auto scan = scan_of(client, 20);
  ASSERT_EQ(scan.getScanSize(), 1081U);
  EXPECT_NEAR(scan.aperture, 270.0 * kRadPerDeg, 0.01);
  EXPECT_TRUE(scan.rightToLeft);
  EXPECT_GT(right_share(scan, -135.0, 0.25, 30.0), 0.98);
}

TEST_F(Mrpt, ReadsAHokuyoUrg) {
  mrpt::hwdrivers::CHokuyoURG client;
  connect(client, "urg-04lx", "HOKUYO_motorSpeed_rpm = 0\n");
  initialize(client);
  const auto scan = scan_of(client, 10);
  ASSERT_EQ(scan.getScanSize(), 682U);
  EXPECT_GT(right_share(scan, (44 - 384) * 360.0 / 1024.0, 360.0 / 1024.0, 5.5), 0.97);
}

TEST_F(Mrpt, ReadsASick) {
  for (const char* const settings : {"COM_baudRate = 38400\nmm_mode = 1\nFOV = 180\nresolution = 50\n",
                                     "COM_baudRate = 500000\nmm_mode = 0\nFOV = 180\nresolution = 100\n",
                                     "COM_baudRate = 9600\nmm_mode = 1\nFOV = 180\nresolution = 100\n"}) {
    SCOPED_TRACE(settings);
    mrpt::hwdrivers::CSickLaserSerial client;
    connect(client, "lms291", settings);
    initialize(client);
    const auto scan = scan_of(client, 5);
    const bool is_half = std::string(settings).find("= 50\n") != std::string::npos;
    ASSERT_EQ(scan.getScanSize(), is_half ? 361U : 181U);
    EXPECT_TRUE(scan.rightToLeft);
    EXPECT_GT(right_share(scan, -90.0, is_half ? 0.5 : 1.0, 80.0), 0.98);
  }
}

// This client (2.5.8) takes the angles of its newer library, 65536 to a turn, for those of the older one, in 1/64
// degree with a flag below: entry i of its 360 holds what was seen from i to i + 1 512ths of a turn, clockwise from the
// front.
TEST_F(Mrpt, ReadsAnRplidar) {
  for (const char* const model :
       {"rplidar-a1-1.16", "rplidar-a1", "rplidar-a2"}) {  // the first by the standard scan, the others by capsules
    SCOPED_TRACE(model);
    mrpt::hwdrivers::CRoboPeakLidar client;
    connect(client, model, "");
    initialize(client);
    const auto scan = scan_of(client, 8);
    ASSERT_EQ(scan.getScanSize(), 360U);
    EXPECT_FALSE(scan.rightToLeft);
    const World world = parse_world(kWorld, "room");
    int seen = 0;
    int right = 0;
    for (std::size_t i = 0; i < scan.getScanSize(); ++i) {
      const double angle_rad = -(static_cast<double>(i) + 0.5) / 512.0 * 2.0 * std::numbers::pi;
      const double true_m = cast_ray_m(world, {3.0, 2.0}, {std::cos(angle_rad), std::sin(angle_rad)});
      seen += scan.getScanRangeValidity(i) ? 1 : 0;
      right += scan.getScanRangeValidity(i) && std::abs(scan.getScanRange(i) - true_m) < 0.06 ? 1 : 0;
    }
    EXPECT_GT(seen, 230);
    EXPECT_GT(right, 0.96 * seen);
  }
}

}  // namespace
}  // namespace odoless
