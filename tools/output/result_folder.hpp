#pragma once

#include <filesystem>

#include "drivers/io/file_descriptor.hpp"

namespace odoless {

/// What a run writes into its folder last: where it is, all other files are there and belong to it.
inline constexpr const char* kSummaryFile = "summary.json";

/// A folder of results of one run, which never mixes with those of another, whenever the program or the machine stops.
///
/// They are written into a folder `.unfinished-...` beside it, which takes its name in the end. In a folder that is
/// there already (an empty one, or any where that is forced), it is in there, and the files are moved out of it, the
/// summary last; results of a run before, which had to be forced, are removed first. What a program that was killed has
/// left unfinished is removed by the next.
class ResultFolder {
 public:
  /// @param is_forced  Results that are there already are replaced; without it only an empty folder, or none, will do.
  /// @throws CannotCreateError where it will not do, or cannot be made.
  ResultFolder(const std::filesystem::path& folder, bool is_forced);
  /// Without `finish` nothing is left of it.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;
  ResultFolder(ResultFolder&&) = delete;
  ResultFolder& operator=(ResultFolder&&) = delete;

  /// Files are to be written here.
  [[nodiscard]] const std::filesystem::path& unfinished() const { return unfinished_; }
  /// All files are written. @return  False where somebody else has made the folder meanwhile; nothing is lost then.
  [[nodiscard]] bool take_name(const std::filesystem::path& folder);
  /// The same under the name that was wished for. @throws CannotCreateError where somebody else has taken it.
  void finish();

 private:
  void begin(const std::filesystem::path& place);
  void move_out();

  std::filesystem::path folder_;
  bool is_there_ = false;  ///< already: the unfinished one is in it
  std::filesystem::path unfinished_;
  FileDescriptor lock_;  ///< on what is unfinished, while this lives
};

/// Removes such a folder, as a whole or not at all: what is cut short is unfinished.
void remove_result_folder(const std::filesystem::path& folder);

}  // namespace odoless
