#include "firmware/world/world_reader.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/graph/world_parts.hpp"
#include "firmware/world/world_blobs.hpp"

namespace odoless {
namespace {

constexpr double kFarthest_m = 1e5;  // from the origin of its map
constexpr double kAngle_rad = 100.0;
constexpr int kBeams_max = 16384;
constexpr std::int64_t kSerial_max = std::int64_t{1} << 30;
constexpr std::int64_t kKeyframes_max = 4'000'000;
constexpr std::int64_t kSubmaps_max = 200'000;
constexpr std::int64_t kConstraints_max = 2'000'000;

bool is_plausible(const Pose2& pose) {
  return std::abs(pose.x_m) <= kFarthest_m && std::abs(pose.y_m) <= kFarthest_m && std::abs(pose.yaw_rad) <= kAngle_rad;
}

Pose2 pose_in(const Statement& row, int column) {
  return {row.real(column), row.real(column + 1), row.real(column + 2)};
}

/// Reads table by table; the first thing that is wrong ends it.
class Reader {
 public:
  Reader(Database& database, const RobotParams& params) : database_(database), params_(params) {}

  WorldReading read() {
    WorldReading reading;
    // All tables as of one moment, whoever writes meanwhile.
    if (FileFailure failed = database_.run("BEGIN"); failed.any()) {
      return {nullptr, failed.text};
    }
    if (make() && read_sessions() && read_keyframes() && read_submaps() && read_constraints() && read_odometry()) {
      join();
    }
    static_cast<void>(database_.run("COMMIT"));
    return {wrong_.empty() ? std::move(world_) : nullptr, wrong_};
  }

 private:
  struct Mapped {
    Submap submap;
    Pose2 map_T_submap{};
  };
  /// A submap of a session.
  struct Number {
    int session = 0;
    int index = 0;
  };
  struct Held {
    Number from;
    Number to;
    Constraint constraint;
  };

  template <class... Values>
  bool fail(fmt::format_string<Values...> text, Values&&... values) {
    wrong_ = fmt::format(text, std::forward<Values>(values)...);
    return false;
  }

  /// At the end of a table: whether all rows were read.
  bool done(const Statement& rows) { return !rows.has_failed() || fail("{}", database_.failure().text); }

  bool make() {
    const std::int64_t keyframes = integer_of(database_, "SELECT count(*) FROM keyframe");
    const std::int64_t beams = integer_of(database_, "SELECT ifnull(max(beams), 1) FROM keyframe");
    const std::int64_t submaps = integer_of(database_, "SELECT count(*) FROM submap");
    const std::int64_t constraints = integer_of(database_, "SELECT count(*) FROM submap_constraint");
    if (keyframes < 0 || keyframes > kKeyframes_max || beams < 1 || beams > kBeams_max || submaps < 0 ||
        submaps > kSubmaps_max || constraints < 0 || constraints > kConstraints_max) {
      return fail("{} keyframes of up to {} beams, {} submaps, {} constraints cannot be", keyframes, beams, submaps,
                  constraints);
    }
    // Each keyframe that is left may become a submap of its own, with a constraint.
    world_ =
        std::make_unique<StoredWorld>(static_cast<int>(keyframes), static_cast<int>(beams),
                                      static_cast<int>(submaps + keyframes), static_cast<int>(constraints + keyframes));
    Statement identity(database_, "SELECT uuid, created, program, revision FROM world");
    if (!identity.next()) {
      return fail("it says of no world which one it is");
    }
    world_->identity = {identity.text(0), identity.text(1), identity.text(2), identity.integer(3)};
    return true;
  }

  bool read_sessions() {
    Statement rows(database_, "SELECT id, started, program, configuration, seed FROM session ORDER BY id");
    while (rows.next()) {
      ids_.push_back(rows.integer(0));
      StoredSession& session = world_->sessions.emplace_back();
      session.id = rows.integer(0);
      session.about = {rows.text(1), rows.text(2), rows.text(3), rows.integer(4)};
    }
    mapped_.resize(ids_.size());
    return done(rows);
  }

  /// Of its id; -1: there is none.
  [[nodiscard]] int session_of(std::int64_t id) const {
    const auto at = std::lower_bound(ids_.begin(), ids_.end(), id);
    return at != ids_.end() && *at == id ? static_cast<int>(at - ids_.begin()) : -1;
  }

  bool read_keyframes() {
    Statement rows(database_,
                   "SELECT id, session, stamp_ns, start_angle_rad, angle_step_rad, beams, map_number, odom_x_m, "
                   "odom_y_m, odom_yaw_rad, map_odom_x_m, map_odom_y_m, map_odom_yaw_rad, since_last, ranges "
                   "FROM keyframe ORDER BY id");
    int session = 0;
    while (rows.next()) {
      const int at = world_->store.size();
      const int of = session_of(rows.integer(1));
      if (of < session) {
        return fail("keyframe {}: its session cannot be", rows.integer(0));
      }
      if (!add_keyframe(rows)) {
        return fail("keyframe {}: a number in it cannot be", rows.integer(0));
      }
      session = of;
      StoredSession& mine = world_->sessions[static_cast<std::size_t>(of)];
      mine.first_keyframe = mine.keyframes == 0 ? at : mine.first_keyframe;
      ++mine.keyframes;
    }
    return done(rows);
  }

  bool add_keyframe(const Statement& row) {
    Keyframe keyframe;
    keyframe.stamp_ns = row.integer(2);
    keyframe.start_angle_rad = row.real(3);
    keyframe.angle_step_rad = row.real(4);
    keyframe.map_number = static_cast<std::int32_t>(row.integer(6));
    keyframe.odom_T_scan = pose_in(row, 7);
    keyframe.map_T_odom = pose_in(row, 10);
    const std::int64_t beams = row.integer(5);
    if (row.integer(0) < 0 || row.integer(0) > kSerial_max || beams < 1 || beams > kBeams_max ||
        !(std::abs(keyframe.start_angle_rad) <= kAngle_rad) || !(std::abs(keyframe.angle_step_rad) <= kAngle_rad) ||
        keyframe.angle_step_rad == 0.0 || !is_plausible(keyframe.odom_T_scan) || !is_plausible(keyframe.map_T_odom) ||
        !unpack_stretch(row.bytes(13), keyframe.since_last) || !is_plausible(keyframe.since_last.start_T_end)) {
      return false;
    }
    keyframe.beams = static_cast<std::int32_t>(beams);
    codes_.resize(static_cast<std::size_t>(beams));
    if (!unpack_beams(row.bytes(14), codes_)) {
      return false;
    }
    world_->store.add(keyframe, codes_, static_cast<int>(row.integer(0)));
    return true;
  }

  bool read_submaps() {
    Statement rows(database_,
                   "SELECT id, session, first_keyframe, keyframes, map_x_m, map_y_m, map_yaw_rad FROM submap "
                   "ORDER BY id");
    while (rows.next()) {
      const auto at = static_cast<std::int64_t>(stored_.size());
      const int of = session_of(rows.integer(1));
      if (rows.integer(0) != at || of < 0 || !is_plausible(pose_in(rows, 4))) {
        return fail("submap {}: its number, session or pose cannot be", rows.integer(0));
      }
      const StoredSession& session = world_->sessions[static_cast<std::size_t>(of)];
      const std::int64_t first = rows.integer(2);
      const std::int64_t count = rows.integer(3);
      const int expected = next_keyframe(of);
      if (first != world_->store.serial(expected) || count < 1 ||
          count > session.first_keyframe + session.keyframes - expected) {
        return fail("submap {}: {} keyframes from {} on, where {} comes next", at, count, first,
                    world_->store.serial(expected));
      }
      stored_.push_back(add_submap(of, expected, static_cast<int>(count), pose_in(rows, 4)));
    }
    return done(rows);
  }

  /// The first one of a session that is in none of its submaps.
  [[nodiscard]] int next_keyframe(int session) const {
    const std::vector<Mapped>& mapped = mapped_[static_cast<std::size_t>(session)];
    return mapped.empty() ? world_->sessions[static_cast<std::size_t>(session)].first_keyframe
                          : mapped.back().submap.first_keyframe + mapped.back().submap.keyframes;
  }

  Number add_submap(int session, int first, int count, const Pose2& map_T_submap) {
    std::vector<Mapped>& mapped = mapped_[static_cast<std::size_t>(session)];
    mapped.push_back({make_submap(world_->store, first, count), map_T_submap});
    return {session, static_cast<int>(mapped.size()) - 1};
  }

  bool read_constraints() {
    Statement rows(database_,
                   "SELECT id, from_submap, to_submap, x_m, y_m, yaw_rad, covariance, is_loop_closure, weight "
                   "FROM submap_constraint ORDER BY id");
    const auto submaps = static_cast<std::int64_t>(stored_.size());
    while (rows.next()) {
      const std::int64_t from = rows.integer(1);
      const std::int64_t to = rows.integer(2);
      Constraint constraint;
      constraint.from_T_to = pose_in(rows, 3);
      constraint.is_loop = rows.integer(7) != 0;
      constraint.weight = rows.real(8);
      if (rows.integer(0) != static_cast<std::int64_t>(held_.size()) || from < 0 || to < 0 || from >= submaps ||
          to >= submaps || from == to || !is_plausible(constraint.from_T_to) ||
          !(constraint.weight >= 0.0 && constraint.weight <= 1.0) ||
          !unpack_covariance(rows.bytes(6), constraint.covariance) ||
          constraint.covariance.llt().info() != Eigen::Success) {
        return fail("constraint {} of submaps {} and {} cannot be", rows.integer(0), from, to);
      }
      held_.push_back({stored_[static_cast<std::size_t>(from)], stored_[static_cast<std::size_t>(to)], constraint});
    }
    return done(rows);
  }

  bool read_odometry() {
    Statement rows(database_, "SELECT id, session, poses FROM odometry ORDER BY id");
    while (rows.next()) {
      const int of = session_of(rows.integer(1));
      if (of < 0 || !unpack_poses(rows.bytes(2), world_->sessions[static_cast<std::size_t>(of)].odometry)) {
        return fail("odometry {}: its session or a number in it cannot be", rows.integer(0));
      }
    }
    return done(rows);
  }

  /// Keyframes of a session that are in no submap yet.
  void finish_submaps(int number) {
    const StoredSession& session = world_->sessions[static_cast<std::size_t>(number)];
    std::vector<Mapped>& mapped = mapped_[static_cast<std::size_t>(number)];
    SubmapBuilder builder(params_.graph);
    if (!mapped.empty()) {
      builder.resume(mapped.back().submap, world_->store);
    }
    const auto end_submap = [&] {
      if (!builder.finish(world_->store)) {
        return;
      }
      const Submap& submap = builder.finished();
      const OdometryStretch& odometry = builder.odometry();
      const bool is_first = mapped.empty();
      const Pose2 map_T_submap = is_first ? world_->store[submap.first_keyframe].map_T_odom * submap.odom_T_submap
                                          : mapped.back().map_T_submap * odometry.start_T_end;
      const Number to = add_submap(number, submap.first_keyframe, submap.keyframes, map_T_submap);
      if (!is_first) {
        Constraint constraint;
        constraint.from_T_to = odometry.start_T_end;
        constraint.covariance = odometry.constraint_covariance(params_.limits);
        held_.push_back({{number, to.index - 1}, to, constraint});
      }
    };
    for (int next = next_keyframe(number); next < session.first_keyframe + session.keyframes; ++next) {
      if (builder.is_to_end(world_->store[next].since_last)) {
        end_submap();
      }
      builder.add_stored(next, world_->store);
    }
    end_submap();
  }

  /// Numbers all submaps session by session.
  void join() {
    world_->submaps_in_file = static_cast<int>(stored_.size());
    for (std::size_t i = 0; i < mapped_.size(); ++i) {
      finish_submaps(static_cast<int>(i));
      world_->sessions[i].first_submap = world_->graph.size();
      world_->sessions[i].submaps = static_cast<int>(mapped_[i].size());
      for (const Mapped& each : mapped_[i]) {
        world_->submaps.push_back(each.submap);
        world_->graph.add_node(each.map_T_submap);
      }
    }
    const auto number_of = [&](const Number& number) {
      return world_->sessions[static_cast<std::size_t>(number.session)].first_submap + number.index;
    };
    for (Held& each : held_) {
      each.constraint.from = number_of(each.from);
      each.constraint.to = number_of(each.to);
      world_->graph.add(each.constraint);
    }
  }

  Database& database_;
  const RobotParams& params_;
  std::unique_ptr<StoredWorld> world_;
  std::vector<std::int64_t> ids_;            ///< of sessions
  std::vector<std::vector<Mapped>> mapped_;  ///< by session
  std::vector<Number> stored_;               ///< of the file's submaps
  std::vector<Held> held_;
  std::vector<BeamCode> codes_;
  std::string wrong_;
};

}  // namespace

WorldReading read_world(WorldFile& file, const RobotParams& params) { return Reader(file.database(), params).read(); }

std::optional<PlaceBySubmap> last_place(const StoredWorld& world) {
  const std::vector<bool> tells = tell_places(world.world(), world.graph.size());
  const auto last = std::find_if(world.sessions.rbegin(), world.sessions.rend(), [&](const StoredSession& each) {
    return each.submaps > 0 && tells[static_cast<std::size_t>(each.first_submap + each.submaps - 1)];
  });
  if (last == world.sessions.rend()) {
    return std::nullopt;
  }
  const int submap = last->first_submap + last->submaps - 1;
  const Keyframe& keyframe = world.store[last->first_keyframe + last->keyframes - 1];
  const bool has_scan_behind = !last->odometry.empty() && last->odometry.back().stamp_ns > keyframe.stamp_ns;
  const Pose2 odom_T_scan = has_scan_behind ? last->odometry.back().map_T_scan : keyframe.odom_T_scan;
  return PlaceBySubmap{submap, world.submaps[static_cast<std::size_t>(submap)].odom_T_submap.inverse() * odom_T_scan};
}

std::vector<int> connected_submaps(const PoseGraph& graph, int submap) {
  PoseGraph::Projection projection;
  graph.project(submap, projection);
  std::vector<int> connected;
  for (int i = 0; i < graph.size(); ++i) {
    if (projection.costs[static_cast<std::size_t>(i)] < PoseGraph::kUnreached) {
      connected.push_back(i);
    }
  }
  return connected;
}

WorldPart part_of(const StoredWorld& world, const std::vector<int>& submaps) {
  const std::size_t constraints = world.graph.constraints().size();
  WorldPart part{PoseGraph(static_cast<int>(submaps.size()), static_cast<int>(constraints)), {}, world.store};
  std::vector<int> number(world.submaps.size(), -1);
  for (const int submap : submaps) {
    number[static_cast<std::size_t>(submap)] = part.graph.add_node(world.graph.pose(submap));
    part.submaps.push_back(world.submaps[static_cast<std::size_t>(submap)]);
  }
  for (Constraint each : world.graph.constraints()) {
    each.from = number[static_cast<std::size_t>(each.from)];
    each.to = number[static_cast<std::size_t>(each.to)];
    if (each.from >= 0 && each.to >= 0) {
      part.graph.add(each);
    }
  }
  return part;
}

}  // namespace odoless
