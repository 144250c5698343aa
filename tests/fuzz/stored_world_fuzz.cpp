// Whatever bytes a world file has: it is refused in words, or is a world whose parts fit together.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "core/base/check.hpp"
#include "firmware/world/world_reader.hpp"

namespace {

const std::string& path() {
  static const std::string kPath =
      (std::filesystem::temp_directory_path() / ("odoless-fuzz-" + std::to_string(::getpid()))).string();
  return kPath;
}

void write(const std::uint8_t* data, std::size_t size) {
  std::FILE* const file = std::fopen(path().c_str(), "wb");
  ODOLESS_CHECK(file != nullptr && std::fwrite(data, 1, size, file) == size);
  ODOLESS_CHECK(std::fclose(file) == 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  write(data, size);
  odoless::WorldFile file;
  const odoless::FileFailure failed = file.open_to_read(path());
  ODOLESS_CHECK(failed.any() != failed.text.empty());
  if (!failed.any()) {
    static_cast<void>(file.damage());
    const odoless::WorldReading reading = odoless::read_world(file, {});
    ODOLESS_CHECK((reading.world == nullptr) != reading.wrong.empty());
    for (const odoless::Submap& submap : reading.world ? reading.world->submaps : std::vector<odoless::Submap>{}) {
      ODOLESS_CHECK(submap.first_keyframe >= 0 && submap.keyframes > 0 &&
                    submap.first_keyframe + submap.keyframes <= reading.world->store.size());
    }
    if (reading.world && !reading.world->submaps.empty()) {
      const auto joined = odoless::connected_submaps(reading.world->graph, 0);
      ODOLESS_CHECK(odoless::part_of(*reading.world, joined).submaps.size() == joined.size());
    }
  }
  file.close();
  static_cast<void>(::unlink(path().c_str()));
  return 0;
}
