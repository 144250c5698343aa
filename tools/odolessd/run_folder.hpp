#pragma once

#include <filesystem>
#include <functional>

namespace odoless {

/// The folder of a run among those of others: FOLDER/YYYY-MM-DDThh-mm-ssZ, with -2 and so on where the name is taken,
/// and FOLDER/latest, a link to the one that was written last.
///
/// Each save writes a folder of its own and then removes that of the save before: whenever the program or the machine
/// stops, what was saved last is there as a whole.
class RunFolder {
 public:
  explicit RunFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// @param write  Writes all files into the folder that it is given.
  /// @return       The folder that they are in now. @throws UserError, with nothing lost of what was saved before.
  std::filesystem::path save(const std::function<void(const std::filesystem::path&)>& write);

 private:
  std::filesystem::path folder_;
  std::filesystem::path last_;
};

}  // namespace odoless
