#include "tools/experiment/route.hpp"

#include <array>
#include <cmath>

namespace odoless {
namespace {

constexpr std::array<Place, 4> kRoomsPlaces{
    {{'A', {1.9, 1.7}}, {'B', {7.2, 1.7}}, {'C', {7.4, 6.4}}, {'D', {1.8, 6.4}}}};
constexpr double kArrivedM = 0.3;

double distance_m(const ReferencePose& pose, const Place& place) {
  return std::hypot(pose.pose.x_m - place.position.x_m, pose.pose.y_m - place.position.y_m);
}

}  // namespace

std::span<const Place> rooms_places() { return kRoomsPlaces; }

std::vector<Arrival> arrivals(std::span<const ReferencePose> poses, std::span<const Place> places) {
  std::vector<Arrival> found;
  const Place* here = nullptr;
  double nearest_m = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Place* now = nullptr;
    for (const Place& place : places) {
      now = distance_m(poses[i], place) <= kArrivedM ? &place : now;
    }
    if (now != nullptr && now != here) {
      found.push_back({now->letter, i});
      nearest_m = distance_m(poses[i], *now);
    } else if (now != nullptr && distance_m(poses[i], *now) < nearest_m) {
      found.back().index = i;
      nearest_m = distance_m(poses[i], *now);
    }
    here = now;
  }
  return found;
}

}  // namespace odoless
