#include "tools/output/whole_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr std::size_t kWaitingMax_bytes = std::size_t{8} << 20;

std::string failure(const std::filesystem::path& path, const char* what, const std::string& reason) {
  return fmt::format("{}: {}: {}", path.string(), what, reason);
}

[[noreturn]] void fail_to_write(const std::filesystem::path& path, int error_number) {
  throw IoError(failure(path, "writing failed", system_reason(error_number)), error_number);
}

}  // namespace

WholeFile::WholeFile(std::filesystem::path path) : path_(std::move(path)), unfinished_(path_.string() + ".tmp") {
  file_.reset(::open(unfinished_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file_.valid()) {
    is_finished_ = true;
    const int error_number = errno;
    throw CannotCreateError(failure(path_, "cannot be created", system_reason(error_number)), error_number);
  }
}

WholeFile::~WholeFile() {
  if (!is_finished_) {
    static_cast<void>(::unlink(unfinished_.c_str()));
  }
}

void WholeFile::append(std::string_view bytes) {
  waiting_bytes_ += bytes.size();
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_.get(), bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      fail_to_write(path_, errno);
    }
  }
  if (waiting_bytes_ >= kWaitingMax_bytes) {
    synchronise();
  }
}

void WholeFile::synchronise() {
  waiting_bytes_ = 0;
  if (::fsync(file_.get()) != 0 && errno != EINVAL) {  // EINVAL: what takes it is no disk
    fail_to_write(path_, errno);
  }
}

void WholeFile::finish() {
  synchronise();
  if (::close(file_.release()) != 0) {
    fail_to_write(path_, errno);
  }
  if (::rename(unfinished_.c_str(), path_.c_str()) != 0) {
    const int error_number = errno;
    throw CannotCreateError(failure(path_, "cannot be created", system_reason(error_number)), error_number);
  }
  is_finished_ = true;
  synchronise_folder(path_.parent_path());
}

void write_whole_file(const std::filesystem::path& path, std::string_view bytes) {
  WholeFile file(path);
  file.append(bytes);
  file.finish();
}

std::string read_whole_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw NoInputError(failure(path, "cannot be opened", system_reason(errno)));
  }
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (file.bad()) {
    throw IoError(failure(path, "reading failed", system_reason(errno)));
  }
  return std::move(bytes).str();
}

void make_output_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw CannotCreateError(failure(folder, "cannot be created", error ? error.message() : "it is a file"),
                            error.value());
  }
}

void synchronise_folder(const std::filesystem::path& folder) {
  const FileDescriptor opened(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened.valid() && errno == EACCES) {
    return;  // one that may be written to and not be read
  }
  if (!opened.valid() || (::fsync(opened.get()) != 0 && errno != EINVAL)) {
    fail_to_write(folder, errno);
  }
}

}  // namespace odoless
