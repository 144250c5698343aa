#include "firmware/publisher/pose_spool.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace odoless {
namespace {

constexpr std::size_t kAtOnce = 64;

off_t place_of(std::size_t entry) { return static_cast<off_t>(entry * sizeof(PoseSpool::Entry)); }

}  // namespace

PoseSpool::PoseSpool(const std::filesystem::path& folder) {
  if (folder.empty()) {
    return;
  }
  file_.reset(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  error_ = file_.valid() ? 0 : errno;
  waiting_.reserve(kWaitingMax);
}

void PoseSpool::add(const PoseRecord& pose) {
  if (!file_.valid()) {
    return;
  }
  const std::lock_guard lock(mutex_);
  if (waiting_.size() < kWaitingMax) {
    waiting_.push_back({pose.stamp_ns, pose.map_T_scan, pose.update_stamp_ns, pose.update_T_scan, pose.odom_T_scan});
  }
  if (waiting_.size() >= kAtOnce) {
    write_waiting();
  }
}

// A write that was cut short is done anew at the same place.
void PoseSpool::write_waiting() {
  const auto* const bytes = reinterpret_cast<const char*>(waiting_.data());
  const std::size_t size_bytes = waiting_.size() * sizeof(Entry);
  for (std::size_t at = 0; at < size_bytes;) {
    const ssize_t done =
        ::pwrite(file_.get(), bytes + at, size_bytes - at, place_of(written_) + static_cast<off_t>(at));
    if (done <= 0) {
      error_ = done < 0 ? errno : EIO;
      return;
    }
    at += static_cast<std::size_t>(done);
  }
  written_ += waiting_.size();
  waiting_.clear();
  error_ = 0;
}

std::size_t PoseSpool::size() {
  if (!file_.valid()) {
    return 0;
  }
  const std::lock_guard lock(mutex_);
  write_waiting();
  return written_;
}

int PoseSpool::read(std::size_t first, std::span<Entry> entries) const {
  auto* const bytes = reinterpret_cast<char*>(entries.data());
  for (std::size_t at = 0; at < entries.size_bytes();) {
    const ssize_t done =
        ::pread(file_.get(), bytes + at, entries.size_bytes() - at, place_of(first) + static_cast<off_t>(at));
    if (done <= 0) {
      return done < 0 ? errno : EIO;
    }
    at += static_cast<std::size_t>(done);
  }
  return 0;
}

}  // namespace odoless
