#include "tools/output/world_merge.hpp"

#include <algorithm>
#include <string>
#include <system_error>

#include "core/base/check.hpp"
#include "core/graph/submap_graph.hpp"
#include "tools/command/error.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/output/world_output.hpp"

namespace odoless {
namespace {

/// A folder beside a file in which that is made, with all that SQLite has beside a file. What a program that was killed
/// has left there would go into the new one: it is removed first.
class UnfinishedWorld {
 public:
  explicit UnfinishedWorld(const std::filesystem::path& out)
      : out_(out), folder_(out.parent_path() / (".unfinished-" + out.filename().string())) {
    std::filesystem::remove_all(folder_);
    make_output_folder(folder_);
  }
  ~UnfinishedWorld() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  UnfinishedWorld(const UnfinishedWorld&) = delete;
  UnfinishedWorld& operator=(const UnfinishedWorld&) = delete;

  [[nodiscard]] std::filesystem::path file() const { return folder_ / "world"; }
  void finish() {
    std::filesystem::rename(file(), out_);
    synchronise_folder(out_.parent_path());
  }

 private:
  std::filesystem::path out_;
  std::filesystem::path folder_;
};

/// The configuration's pools, or larger ones where both worlds need them, and the world is then not full.
GraphParams with_room(GraphParams params, const StoredWorld& into, const StoredWorld& from) {
  const auto larger = [](int most, int needed) { return std::max(most, needed + needed / 3 + 2); };
  const auto submaps = static_cast<int>(from.submaps.size());
  const auto constraints = static_cast<int>(into.graph.constraints().size());
  params.keyframes_max = larger(params.keyframes_max, into.store.size() + from.store.size());
  params.keyframe_beams_max = std::max({params.keyframe_beams_max, into.store.most_beams(), from.store.most_beams()});
  params.submaps_max = larger(params.submaps_max, into.graph.size() + 2 * submaps + 1);
  params.constraints_max = larger(params.constraints_max, constraints + (params.candidates + 2) * (2 * submaps + 1));
  return params;
}

int closures_with_others(const SubmapGraph& graph) {
  const auto first = static_cast<int>(graph.first_submap());
  return static_cast<int>(std::ranges::count_if(graph.graph().constraints(), [&](const Constraint& each) {
    return each.is_loop && each.holds() && (each.from < first) != (each.to < first);
  }));
}

MergedSession merge_one(const StoredWorld& from, const SessionToMerge& wanted, const std::filesystem::path& into,
                        const std::function<void(int)>& progress) {
  const StoredSession& session = from.sessions[wanted.number];
  WorldOutput output(into, session.about.program, wanted.params);
  MergedSession merged{.number = wanted.number, .submaps = session.submaps};
  SubmapGraph graph(with_room(wanted.params.graph, *output.world(), from), wanted.params.limits, wanted.params.scan,
                    static_cast<std::uint64_t>(session.about.seed));
  ODOLESS_CHECK(graph.resume(output.world()->world()));
  for (int i = 0; i < session.keyframes; ++i) {
    const int k = session.first_keyframe + i;
    for (bool is_at_work = graph.add(from.store[k], from.store.codes(k)); is_at_work; is_at_work = graph.work()) {
    }
    progress(i + 1);
  }
  graph.finish();
  merged.submaps = static_cast<int>(graph.submaps().size() - graph.first_submap());
  merged.closures = closures_with_others(graph);
  merged.is_joined = graph.is_joined() && merged.closures >= kClosures_min;
  if (merged.is_joined) {
    output.write(session.about, graph, session.odometry);
  }
  return merged;
}

}  // namespace

std::vector<MergedSession> merge_sessions(WorldFile& into, const StoredWorld& from,
                                          const std::vector<SessionToMerge>& sessions, const std::filesystem::path& out,
                                          const MergeProgress& progress) {
  UnfinishedWorld made(out);
  if (const FileFailure failed = into.copy_to(made.file()); failed.any()) {
    throw CannotCreateError(out.string() + ": " + failed.text);
  }
  std::vector<MergedSession> merged(sessions.size());
  std::vector<int> tried(sessions.size(), -1);  // when so many others had been joined
  std::int64_t done = 0;
  int joined = 0;
  const auto next = [&] {
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      if (!merged[i].is_joined && tried[i] < joined) {
        return i;
      }
    }
    return sessions.size();
  };
  for (std::size_t i = next(); i < sessions.size(); i = next()) {
    tried[i] = joined;
    merged[i] = merge_one(from, sessions[i], made.file(), [&](int keyframes) { progress(done + keyframes); });
    if (merged[i].is_joined) {
      done += from.sessions[sessions[i].number].keyframes;
      ++joined;
    }
  }
  if (joined > 0) {
    made.finish();
  }
  return merged;
}

}  // namespace odoless
