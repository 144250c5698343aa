#include "tools/replay/places.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/rng.hpp"
#include "firmware/world/continued_world.hpp"
#include "tools/command/error.hpp"
#include "tools/replay/mapper.hpp"

namespace odoless {
namespace {

double seconds_of(std::int64_t stamp_ns) { return static_cast<double>(stamp_ns) * 1e-9; }

bool is_seen(const SubmapWorld& world, const std::optional<Pose2>& map_T_scan) {
  bool is_near = false;
  for_each_keyframe(world, [&](int, const Pose2& map_T_keyframe) {
    is_near = is_near || (map_T_scan && map_T_keyframe.distance_m(*map_T_scan) <= TriedPlace::kSeen_m);
  });
  return is_near;
}

TriedPlace try_place(const KnownDrive& drive, std::size_t first, Mapper mapper, const PlacesParams& wanted) {
  const std::vector<LogScan>& scans = drive.log.scans;
  TriedPlace place{.stamp_s = seconds_of(scans[first].stamp_ns)};
  for (std::size_t i = first; i < scans.size(); ++i) {
    const LogScan& scan = scans[i];
    const double after_s = seconds_of(scan.stamp_ns) - place.stamp_s;
    if (after_s > wanted.watched_s) {
      break;
    }
    const ChainStep step = mapper.process(scan.raw(), scan.is_level);
    const bool is_sure = step.filter.tracking == Tracking::kSure && mapper.graph()->is_in_world();
    const std::optional<Pose2> known = drive.truth.nearest(seconds_of(scan.stamp_ns), wanted.tolerance_s);
    if (step.filter.tracking == Tracking::kLost || !(mapper.graph()->is_in_world() || mapper.graph()->is_guessed()) ||
        !known) {
      continue;
    }
    const bool is_right = are_within(step.filter.map_T_scan, *known, PoseEstimate::kOk_m, PoseEstimate::kOk_rad);
    place.told_after_s = is_right && place.told_after_s < 0.0 ? after_s : place.told_after_s;
    if (is_sure) {
      place.sure_after_s = place.sure_after_s < 0.0 ? after_s : place.sure_after_s;
      place.errors_m.push_back(step.filter.map_T_scan.distance_m(*known));
      place.wrong_scans += is_right ? 0 : 1;
    } else {
      ++place.guessed_scans;
      place.wrong_guesses += is_right ? 0 : 1;
    }
  }
  return place;
}

}  // namespace

std::vector<TriedPlace> try_places(const KnownDrive& drive, const StoredWorld& world, const RobotParams& params,
                                   const PlacesParams& wanted, const std::function<void(int done)>& progress) {
  const std::vector<LogScan>& scans = drive.log.scans;
  const double last_s = seconds_of(scans.back().stamp_ns) - wanted.watched_s;
  const auto end = std::ranges::find_if(scans, [&](const LogScan& each) { return seconds_of(each.stamp_ns) > last_s; });
  const auto starts = static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(1, end - scans.begin()));
  Rng rng(wanted.seed, 3);
  std::vector<TriedPlace> places;
  for (int i = 0; i < wanted.places; ++i) {
    Mapper mapper(params, wanted.seed + static_cast<std::uint64_t>(i));
    if (!mapper.resume(world.world(), WorldUse::kLocalise, std::nullopt)) {
      throw UsageError("the world has no room: " + no_room_sentence(world, params.graph));
    }
    const std::size_t first = rng.below(starts);
    places.push_back(try_place(drive, first, std::move(mapper), wanted));
    places.back().is_seen =
        is_seen(world.world(), drive.truth.nearest(seconds_of(scans[first].stamp_ns), wanted.tolerance_s));
    progress(i + 1);
  }
  return places;
}

Report report(const std::vector<TriedPlace>& tried, const PlacesParams& wanted) {
  std::vector<double> errors_m;
  std::vector<double> told_s;
  std::vector<double> sure_s;
  TriedPlace sum;
  int soon = 0;
  int seen = 0;
  int seen_soon = 0;
  int wrong = 0;
  Report out;
  for (const TriedPlace& each : tried) {
    errors_m.insert(errors_m.end(), each.errors_m.begin(), each.errors_m.end());
    if (each.told_after_s >= 0.0) {
      told_s.push_back(each.told_after_s);
    }
    if (each.sure_after_s >= 0.0) {
      sure_s.push_back(each.sure_after_s);
    }
    const bool is_soon = each.told_after_s >= 0.0 && each.told_after_s <= wanted.in_time_s;
    soon += is_soon ? 1 : 0;
    seen += each.is_seen ? 1 : 0;
    seen_soon += is_soon && each.is_seen ? 1 : 0;
    wrong += each.wrong_scans > 0 ? 1 : 0;
    sum.guessed_scans += each.guessed_scans;
    sum.wrong_guesses += each.wrong_guesses;
    out.json["places"].push_back({{"stamp_s", each.stamp_s},
                                  {"seen", each.is_seen},
                                  {"told_after_s", each.told_after_s},
                                  {"sure_after_s", each.sure_after_s},
                                  {"wrong_scans", each.wrong_scans}});
  }
  const std::size_t told = told_s.size();
  const std::size_t sure = sure_s.size();
  const Statistics told_after = summarise(std::move(told_s));
  const Statistics sure_after = summarise(std::move(sure_s));
  const Statistics error = summarise(std::move(errors_m));
  out.text = fmt::format(
      "right pose       in {} of {} places, in {} within {} s of scans; after {:.1f} s (median), {:.1f} s (95 %)\n"
      "seen before      {} of {} places (a scan of the world is from within {} m): the right pose within {} s in {} of "
      "these\n"
      "state OK         in {} of {} places; after {:.1f} s (median), {:.1f} s (95 %)\n"
      "wrong while OK   in {} of {} places; error {:.3f} m (median), {:.3f} m (95 %), {:.3f} m (largest)\n"
      "guesses          {} of {} scans wrong",
      told, tried.size(), soon, wanted.in_time_s, told_after.median, told_after.percentile_95, seen, tried.size(),
      TriedPlace::kSeen_m, wanted.in_time_s, seen_soon, sure, tried.size(), sure_after.median, sure_after.percentile_95,
      wrong, tried.size(), error.median, error.percentile_95, error.max, sum.wrong_guesses, sum.guessed_scans);
  out.json["told"] = told;
  out.json["told_in_time"] = soon;
  out.json["seen"] = seen;
  out.json["seen_told_in_time"] = seen_soon;
  out.json["sure"] = sure;
  out.json["wrong"] = wrong;
  out.json["error_median_m"] = error.median;
  out.json["error_max_m"] = error.max;
  return out;
}

}  // namespace odoless
