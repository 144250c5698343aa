#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/io/file_descriptor.hpp"

namespace odoless {

/// A file that appears whole or not at all, whenever the program or the machine stops: it is written to `path`.tmp,
/// which is synchronised with the disk and then takes its place. What goes wrong is thrown as CannotCreateError or
/// IoError with the path and the system's reason, and nothing is left behind.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path path);
  /// Without `finish` nothing is left of it.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;
  WholeFile(WholeFile&&) = delete;
  WholeFile& operator=(WholeFile&&) = delete;

  /// Of a large file, every few megabytes go to the disk, so that the end does not take long.
  void append(std::string_view bytes);
  void finish();

 private:
  void synchronise();

  std::filesystem::path path_;
  std::filesystem::path unfinished_;
  FileDescriptor file_;
  std::size_t waiting_bytes_ = 0;  ///< for the disk
  bool is_finished_ = false;
};

/// Such a file of these bytes.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

/// All bytes of a file. @throws NoInputError, IoError.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

/// Makes a folder for results, with its parents, unless it is there. @throws CannotCreateError.
void make_output_folder(const std::filesystem::path& folder);

/// What was made, renamed or removed in a folder is on the disk after this. @throws IoError.
void synchronise_folder(const std::filesystem::path& folder);

}  // namespace odoless
