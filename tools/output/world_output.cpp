#include "tools/output/world_output.hpp"

#include <cerrno>
#include <utility>

#include "firmware/world/world_mirror.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr const char* kRight = "a world file of `odolessd --world` or `odoless replay --world`";

}  // namespace

WorldOutput::WorldOutput(std::filesystem::path path, const std::string& program, const RobotParams& params,
                         WorldUse use)
    : path_(std::move(path)) {
  const bool is_read_only = use == WorldUse::kLocalise;
  FileFailure failed = is_read_only ? file_.open_to_read(path_) : file_.open_to_write(path_, program);
  failed = failed.any() ? failed : world_.read(file_, params, use);
  if (failed.error == EBADMSG) {
    throw DataError(path_.string(), 0, failed.text, kRight);
  }
  if (failed.any() && is_read_only) {
    throw NoInputError(path_.string() + ": " + failed.text);
  }
  if (failed.any()) {
    throw CannotCreateError(path_.string() + ": " + failed.text);
  }
  if (!is_read_only) {
    left_out_ = world_.make_room(file_, params.graph);
  }
}

void WorldOutput::write(const SessionRecord& session, const SubmapGraph& graph, std::span<const StampedPose> odom) {
  WorldPlace place;
  WorldMirror mirror = world_.mirror();
  if (graph.is_localising() && mirror.has_keyframes_of(graph)) {
    return file_.close();
  }
  FileFailure failed = file_.begin(session, place);
  place = {.session = place.session};
  WorldChanges changes;
  changes.odometry.assign(odom.begin(), odom.end());
  for (bool has_more = true; has_more && !failed.any();) {
    has_more = mirror.collect(graph, changes);
    failed = file_.write(place, changes);
    mirror.take(changes);
    changes = {};
  }
  file_.close();
  if (failed.any()) {
    throw IoError(path_.string() + ": " + failed.text);
  }
}

void open_world(const std::filesystem::path& path, WorldFile& file) {
  const FileFailure failed = file.open_to_read(path);
  if (failed.error == EBADMSG) {
    throw DataError(path.string(), 0, failed.text, kRight);
  }
  if (failed.any()) {
    throw NoInputError(path.string() + ": " + failed.text);
  }
}

}  // namespace odoless
