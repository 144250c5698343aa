#include "tools/output/whole_file.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

#include "tools/command/error.hpp"

namespace odoless {
namespace {

std::string failure(const std::filesystem::path& path, const char* what, const std::string& reason) {
  return fmt::format("{}: {}: {}", path.string(), what, reason);
}

void write_bytes(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  if (!file) {
    throw CannotCreateError(failure(path, "cannot be created", system_reason(errno)));
  }
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    const int error_number = errno;
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw IoError(failure(path, "writing failed", system_reason(error_number)));
  }
}

}  // namespace

void write_whole_file(const std::filesystem::path& path, std::string_view bytes) {
  std::filesystem::path unfinished = path;
  unfinished += ".tmp";
  write_bytes(unfinished, bytes);
  std::error_code error;
  std::filesystem::rename(unfinished, path, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw CannotCreateError(failure(path, "cannot be created", error.message()));
  }
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
    throw CannotCreateError(failure(folder, "cannot be created", error ? error.message() : "it is a file"));
  }
}

}  // namespace odoless
