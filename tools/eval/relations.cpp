#include "tools/eval/relations.hpp"

#include <cmath>

#include "tools/command/error.hpp"
#include "tools/log/fields.hpp"

namespace odoless {
namespace {

constexpr const char* kLayout = "t1 t2 x y z roll pitch yaw";

Relation parse_relation(const Fields& fields) {
  constexpr std::size_t kColumns = 8;
  if (fields.size() != kColumns) {
    fields.fail("this is no relation", kLayout);
  }
  return {fields.number(0, "t1"), fields.number(1, "t2"),
          Pose2{fields.number(2, "x"), fields.number(3, "y"), fields.number(7, "yaw")}};
}

void count(const Relation& relation, const PoseError& error, RelationsResult& result) {
  if (std::abs(relation.to_s - relation.from_s) <= kOneVisit_s) {
    ++result.one_visit.used;
    const bool is_off =
        error.translation_m > kOffOnOneVisit.translation_m || error.rotation_rad > kOffOnOneVisit.rotation_rad;
    result.one_visit.off += is_off ? 1 : 0;
  } else {
    ++result.across_loops.used;
    result.across_loops.off += error.translation_m > kOffAcrossALoop_m ? 1 : 0;
  }
}

}  // namespace

std::vector<Relation> read_relations(const std::filesystem::path& path) {
  LineReader lines(open_bytes(path), path.string());
  std::vector<Relation> relations;
  Fields fields;
  std::string_view line;
  while (lines.next(line)) {
    fields.split(line, lines);
    if (fields.size() > 0 && !fields.text(0).starts_with('#')) {
      lines.keep(sizeof(Relation));
      relations.push_back(parse_relation(fields));
    }
  }
  if (relations.empty()) {
    throw DataError(lines.name(), 0, "there are no relations", kLayout);
  }
  return relations;
}

RelationsResult evaluate_relations(std::span<const Relation> relations, std::span<const ReferencePose> estimate,
                                   const Association& association) {
  const StampLookup lookup(estimate);
  RelationsResult result;
  std::vector<PoseError> errors;
  for (const Relation& relation : relations) {
    const auto map_T_from = lookup.nearest(relation.from_s, association.tolerance_s);
    const auto map_T_to = lookup.nearest(relation.to_s, association.tolerance_s);
    if (!map_T_from || !map_T_to) {
      ++result.missing;
      continue;
    }
    const Pose2 from_T_to = robot_motion(map_T_from->inverse() * *map_T_to, association.laser_x_m);
    errors.push_back(pose_error(relation.from_T_to, from_T_to));
    count(relation, errors.back(), result);
  }
  result.used = errors.size();
  result.errors = summarise(errors);
  return result;
}

}  // namespace odoless
