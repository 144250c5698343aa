#include "tools/output/whole_file.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>

#include "tools/command/error.hpp"

namespace odoless {
namespace {

std::string failure(const std::filesystem::path& path, const char* what, const std::string& reason) {
  return fmt::format("{}: {}: {}", path.string(), what, reason);
}

void write_bytes(const std::filesystem::path& path, std::string_view bytes) {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) {
    throw CannotCreateError(failure(path, "cannot be created", std::strerror(errno)));
  }
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() && std::fflush(file) == 0;
  const int write_error = errno;
  const bool closed = std::fclose(file) == 0;
  if (!written || !closed) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw IoError(failure(path, "writing failed", std::strerror(written ? errno : write_error)));
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

void make_output_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw CannotCreateError(failure(folder, "cannot be created", error ? error.message() : "it is a file"));
  }
}

}  // namespace odoless
