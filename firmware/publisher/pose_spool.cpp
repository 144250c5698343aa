#include "firmware/publisher/pose_spool.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace odoless {

PoseSpool::PoseSpool(const std::filesystem::path& folder) {
  if (folder.empty()) {
    return;
  }
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0) {
    file_.reset(::fdopen(descriptor, "w+"));
  }
  error_ = file_ ? 0 : errno;
}

void PoseSpool::add(const PoseRecord& pose) {
  if (!file_) {
    return;
  }
  const Entry entry{pose.stamp_ns, pose.map_T_scan, pose.update_stamp_ns, pose.update_T_scan, pose.odom_T_scan};
  if (std::fwrite(&entry, sizeof(entry), 1, file_.get()) != 1) {
    error_ = errno;
  }
}

std::vector<PoseSpool::Entry> PoseSpool::read_all() {
  std::vector<Entry> entries;
  if (file_ && std::fseek(file_.get(), 0, SEEK_SET) == 0) {
    for (Entry entry; std::fread(&entry, sizeof(entry), 1, file_.get()) == 1;) {
      entries.push_back(entry);
    }
    static_cast<void>(std::fseek(file_.get(), 0, SEEK_END));
  }
  return entries;
}

std::vector<StampedPose> PoseSpool::online() {
  std::vector<StampedPose> poses;
  for (const Entry& entry : read_all()) {
    poses.push_back({entry.stamp_ns, entry.map_T_scan});
  }
  return poses;
}

std::vector<StampedPose> PoseSpool::odometry() {
  std::vector<StampedPose> poses;
  for (const Entry& entry : read_all()) {
    poses.push_back({entry.stamp_ns, entry.odom_T_scan});
  }
  return poses;
}

std::vector<StampedPose> PoseSpool::final(std::span<const StampedPose> path) {
  std::vector<StampedPose> poses;
  std::size_t at = 0;  // stamps only grow, in both
  for (const Entry& entry : read_all()) {
    while (at < path.size() && path[at].stamp_ns < entry.update_stamp_ns) {
      ++at;
    }
    const bool known = at < path.size() && path[at].stamp_ns == entry.update_stamp_ns;
    poses.push_back({entry.stamp_ns, known ? path[at].map_T_scan * entry.update_T_scan : entry.map_T_scan});
  }
  return poses;
}

}  // namespace odoless
