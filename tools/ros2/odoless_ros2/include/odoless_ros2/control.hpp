#pragma once

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <odoless_ros2/conversion.hpp>
#include <string>

namespace odoless::ros {

/// The daemon's command that puts the robot where /initialpose says; empty where that is no pose in the map's frame.
/// @param pose  A PoseWithCovarianceStamped of the base, whose covariance the daemon has no use for.
template <class PoseWithCovarianceStamped>
[[nodiscard]] std::string initial_pose_command(const PoseWithCovarianceStamped& pose, const Frames& frames) {
  const Pose2 map_T_base = pose_of(pose.pose.pose);
  if (pose.header.frame_id != frames.map || !std::isfinite(map_T_base.x_m) || !std::isfinite(map_T_base.y_m) ||
      !std::isfinite(map_T_base.yaw_rad)) {
    return "";
  }
  std::array<char, 1024> text{};
  std::snprintf(text.data(), text.size(), "pose %.6f %.6f %.6f", map_T_base.x_m, map_T_base.y_m,
                map_T_base.yaw_rad * 180.0 / std::numbers::pi);
  return text.data();
}

/// Sends a command to the daemon's control socket. @return  Its answer, or why there is none.
[[nodiscard]] inline std::string ask_daemon(const std::string& socket_path, const std::string& command) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_path.size() >= sizeof(address.sun_path)) {
    return socket_path + ": longer than a socket's path can be";
  }
  std::memcpy(address.sun_path, socket_path.c_str(), socket_path.size() + 1);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval patience{.tv_sec = 2, .tv_usec = 0};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  const std::string line = command + "\n";
  std::string answer;
  std::array<char, 4096> piece{};
  ssize_t size_bytes = -1;
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 &&
      ::send(socket, line.data(), line.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(line.size())) {
    while ((size_bytes = ::read(socket, piece.data(), piece.size())) > 0) {
      answer.append(piece.data(), static_cast<std::size_t>(size_bytes));
    }
  }
  const int error = errno;
  ::close(socket);
  return size_bytes == 0 ? answer : socket_path + ": " + std::strerror(error);
}

}  // namespace odoless::ros
