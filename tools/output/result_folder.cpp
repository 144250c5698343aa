#include "tools/output/result_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "tools/command/error.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr const char* kPrefix = ".unfinished-";

/// All that a run may write: what a run before has left is removed where it is to be replaced.
constexpr std::array<std::string_view, 21> kResultFiles{
    kSummaryFile,     "trajectory.tum", "trajectory_online.tum", "map.pgm",
    "map.yaml",       "map.png",        "matches.csv",           "pose_graph.g2o",
    "cloud.ply",      "cloud.pcd",      "cloud_top.png",         "cloud_perspective.png",
    "cloud_keys.png", "tilt_log.csv",   "pose_graph.png",        "replay.mcap",
    "map.svg",        "pose_graph.svg", "cloud_top.svg",         "cloud_perspective.svg",
    "cloud_keys.svg"};

/// Of a world's session: "trajectory_2.tum".
bool is_session_trajectory(std::string_view name) {
  constexpr std::string_view kBegin = "trajectory_";
  constexpr std::string_view kEnd = ".tum";
  if (!name.starts_with(kBegin) || !name.ends_with(kEnd) || name.size() <= kBegin.size() + kEnd.size()) {
    return false;
  }
  const std::string_view number = name.substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size());
  return number.find_first_not_of("0123456789") == std::string_view::npos;
}

[[noreturn]] void fail(const std::filesystem::path& folder, const std::string& what, int error_number) {
  throw CannotCreateError(fmt::format("{}: {}", folder.string(), what), error_number);
}

[[noreturn]] void fail(const std::filesystem::path& folder, int error_number) {
  fail(folder, "cannot be created: " + system_reason(error_number), error_number);
}

FileDescriptor open_locked(const std::filesystem::path& folder) {
  FileDescriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (opened.valid() && ::flock(opened.get(), LOCK_EX | LOCK_NB) != 0) {
    opened.reset();
  }
  return opened;
}

// Who writes into one holds its lock, and nobody holds that of a program which is no more.
void remove_left(const std::filesystem::path& place) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(place, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    struct stat found {};
    const std::filesystem::path& path = entry->path();
    if (path.filename().string().starts_with(kPrefix) && ::lstat(path.c_str(), &found) == 0 &&
        found.st_uid == ::geteuid()) {
      if (const FileDescriptor lock = open_locked(path); lock.valid()) {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
      }
    }
  }
}

bool has_no_files(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_empty(folder, error) && !error;
}

// "a/b/" is "a/b", and a link is what it leads to.
std::filesystem::path plain(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::path whole = std::filesystem::weakly_canonical(std::filesystem::absolute(folder, error), error);
  whole = error ? folder.lexically_normal() : whole;
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

ResultFolder::ResultFolder(const std::filesystem::path& folder, bool is_forced) : folder_(plain(folder)) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::symlink_status(folder_, error);
  is_there_ = status.type() != std::filesystem::file_type::not_found && !error;
  if (is_there_ && status.type() != std::filesystem::file_type::directory) {
    fail(folder_, "cannot be created: it is a file", EEXIST);
  }
  if (is_there_) {
    remove_left(folder_);
    if (!is_forced && !has_no_files(folder_)) {
      fail(folder_,
           "there are files in it, and none is overwritten: another folder is needed, or --force to replace "
           "the results there",
           EEXIST);
    }
  } else {
    make_output_folder(folder_.parent_path());
    remove_left(folder_.parent_path());
  }
  begin(is_there_ ? folder_ : folder_.parent_path());
}

void ResultFolder::begin(const std::filesystem::path& place) {
  constexpr int kTries = 100;
  int error_number = EEXIST;
  for (int i = 0; i < kTries && !lock_.valid(); ++i) {
    unfinished_ = place / fmt::format("{}{}-{}", kPrefix, ::getpid(), i);
    if (::mkdir(unfinished_.c_str(), 0777) != 0) {
      error_number = errno;
      if (error_number != EEXIST) {
        break;
      }
      continue;
    }
    FileDescriptor lock = open_locked(unfinished_);
    // Another program may have taken it for one that was left, before there was a lock.
    if (struct stat found{}; lock.valid() && ::fstat(lock.get(), &found) == 0 && found.st_nlink > 0) {
      lock_ = std::move(lock);
    }
  }
  if (!lock_.valid()) {
    unfinished_.clear();
    fail(folder_, error_number);
  }
}

ResultFolder::~ResultFolder() {
  if (!unfinished_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(unfinished_, ignored);
  }
}

bool ResultFolder::take_name(const std::filesystem::path& folder) {
  synchronise_folder(unfinished_);
  if (::rename(unfinished_.c_str(), folder.c_str()) != 0) {  // replaces nothing but an empty folder
    if (errno == ENOTEMPTY || errno == EEXIST || errno == ENOTDIR) {
      return false;
    }
    fail(folder, errno);
  }
  unfinished_.clear();
  synchronise_folder(folder.parent_path());
  return true;
}

void ResultFolder::finish() {
  if (is_there_) {
    move_out();
  } else if (!take_name(folder_)) {
    fail(folder_, "somebody else has put files there meanwhile", EEXIST);
  }
}

void remove_result_folder(const std::filesystem::path& folder) {
  const std::filesystem::path going = folder.parent_path() / fmt::format("{}{}-gone", kPrefix, ::getpid());
  std::error_code ignored;
  std::filesystem::remove_all(going, ignored);
  if (::rename(folder.c_str(), going.c_str()) == 0) {
    std::filesystem::remove_all(going, ignored);
  }
}

// Without a summary a folder is no result: it goes first and comes last.
void ResultFolder::move_out() {
  const auto move = [this](const std::filesystem::path& name) {
    if (::rename((unfinished_ / name).c_str(), (folder_ / name).c_str()) != 0) {
      fail(folder_ / name, errno);
    }
  };
  synchronise_folder(unfinished_);
  const auto remove = [this](const std::filesystem::path& name) {
    if (::unlink((folder_ / name).c_str()) != 0 && errno != ENOENT) {
      fail(folder_ / name, errno);
    }
  };
  remove(kSummaryFile);
  synchronise_folder(folder_);
  std::ranges::for_each(kResultFiles, remove);
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    if (is_session_trajectory(entry.path().filename().string())) {
      remove(entry.path().filename());
    }
  }
  for (const auto& entry : std::filesystem::directory_iterator(unfinished_)) {
    if (entry.path().filename() != kSummaryFile) {
      move(entry.path().filename());
    }
  }
  synchronise_folder(folder_);
  if (std::filesystem::exists(unfinished_ / kSummaryFile)) {  // an exported world has none
    move(kSummaryFile);
  }
  static_cast<void>(::rmdir(unfinished_.c_str()));
  unfinished_.clear();
  synchronise_folder(folder_);
}

}  // namespace odoless
