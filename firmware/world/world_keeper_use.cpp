// How a world file is closed when the robot only finds its way in it, and opened again to map (world_keeper.hpp).
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>

#include "firmware/daemon/log.hpp"
#include "firmware/world/continued_world.hpp"
#include "firmware/world/world_keeper.hpp"

namespace odoless {

WorldKeeper::Use WorldKeeper::use() const {
  const std::lock_guard lock(mutex_);
  return use_;
}

// What waits of keyframes is in the graph, or no part of the world.
void WorldKeeper::follow(WorldUse use, int map_number, int next_serial) {
  const std::lock_guard lock(mutex_);
  if (use == WorldUse::kContinue) {
    use_ = Use::kMapped;
    report_.is_read_only = false;
    batches_.clear();
  } else {
    use_ = Use::kToBeClosed;
    while (!batches_.empty() && batches_.back().map_number > map_number) {
      batches_.pop_back();
    }
  }
  world_end_ = next_serial;
  Batch& batch = batch_of(map_number);
  batch.next_serial = next_serial;
  batch.keyframes.clear();
}

void WorldKeeper::end_mapping(GraphFeed::Patience patience) {
  FileFailure failed;
  bool has_more = report().error == 0;  // else what came before is not written yet
  bool is_written = false;
  while (has_more && !failed.any()) {
    WorldChanges changes;
    if (!graph_->look(patience, [&](const SubmapGraph& graph, int) { has_more = mirror_.collect(graph, changes); })) {
      return;
    }
    failed = file_.write(*place_, changes);
    if (!failed.any()) {
      mirror_.take(changes);
      is_written = !has_more;
    }
  }
  if (is_written && mirror_.next_serial() > world_end_) {
    failed = file_.erase_keyframes(*place_, world_end_);
    mirror_.forget_keyframes(world_end_);
  }
  if (is_written || failed.any()) {
    note(failed);
  }
  if (is_written && !failed.any()) {
    close();
    log_line(EventPriority::kNotice, fmt::format("world file {}: it stays as it is from now on", params_.file));
  }
}

void WorldKeeper::close() {
  file_.close();
  const std::lock_guard lock(mutex_);
  use_ = Use::kClosed;
  report_.is_read_only = true;
  batches_.clear();
}

void WorldKeeper::begin_mapping() {
  const std::lock_guard lock(mutex_);
  use_ = use_ == Use::kClosed ? Use::kToBeOpened : use_;
  report_.refused.clear();
}

void WorldKeeper::reopen() {
  if (file_.is_open() || is_ending()) {
    return;  // the graph has yet to go over
  }
  const FileFailure failed = open_again();
  if (!failed.any()) {
    return graph_->go_over(WorldUse::kContinue);
  }
  file_.close();
  log_line(EventPriority::kError, fmt::format("world file {}: mapping does not go on: {}", params_.file, failed.text));
  const std::lock_guard lock(mutex_);
  use_ = Use::kClosed;
  report_.refused = failed.text;
}

// The graph has the world as the file had it when it was closed, so it must have it still.
FileFailure WorldKeeper::open_again() {
  if (::access(params_.file.c_str(), F_OK) != 0) {
    return {errno, "it is not there any more; start the daemon anew to begin another"};
  }
  FileFailure failed = file_.open_to_write(params_.file, session_.program);
  const WorldReport known = report();
  if (!failed.any() && (file_.identity().uuid != known.uuid || file_.identity().revision != known.revision)) {
    failed = {ESTALE, "it was replaced or changed meanwhile; start the daemon anew to go on with what it is now"};
  }
  if (!failed.any() && !is_all_in_file_) {
    failed = ContinuedWorld().read(file_, graph_->params(), WorldUse::kContinue);
    is_all_in_file_ = !failed.any();
  }
  WorldPlace place;
  failed = failed.any() ? failed : begin_session(place);
  if (!failed.any()) {
    place_ = place_.value_or(WorldPlace{});
    place_->session = place.session;
    const std::lock_guard lock(mutex_);
    continued_ = mirror_.next_serial();
  }
  return failed;
}

}  // namespace odoless
