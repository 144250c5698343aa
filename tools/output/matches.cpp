#include "tools/output/matches.hpp"

#include <fmt/format.h>

#include <iterator>
#include <limits>

#include "tools/command/error.hpp"
#include "tools/log/fields.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr const char* kColumnNames =
    "reference_index,index,reference_stamp_s,stamp_s,dx_m,dy_m,dyaw_rad,fitness,evaluations,time_us,converged";

int whole(const Fields& fields, std::size_t index, const char* what) {
  return static_cast<int>(fields.count(index, std::numeric_limits<int>::max(), what));
}

MatchRow parse_row(const Fields& fields) {
  constexpr std::size_t kColumns = 11;
  if (fields.size() != kColumns) {
    fields.fail(fmt::format("the line has {} columns", fields.size()), fmt::format("{}: {}", kColumns, kColumnNames));
  }
  return {.reference_index = whole(fields, 0, "reference_index"),
          .index = whole(fields, 1, "index"),
          .reference_stamp_s = fields.number(2, "reference_stamp_s"),
          .stamp_s = fields.number(3, "stamp_s"),
          .reference_T_scan = {fields.number(4, "dx_m"), fields.number(5, "dy_m"), fields.number(6, "dyaw_rad")},
          .fitness = fields.number(7, "fitness"),
          .evaluations = whole(fields, 8, "evaluations"),
          .time_us = fields.number(9, "time_us"),
          .converged = fields.count(10, 1, "converged") == 1};
}

}  // namespace

std::string format_matches(std::span<const MatchRow> rows) {
  std::string text = fmt::format("{}\n", kColumnNames);
  for (const MatchRow& row : rows) {
    const Pose2& motion = row.reference_T_scan;
    fmt::format_to(std::back_inserter(text), "{},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{},{:.1f},{:d}\n",
                   row.reference_index, row.index, row.reference_stamp_s, row.stamp_s, motion.x_m, motion.y_m,
                   motion.yaw_rad, row.fitness, row.evaluations, row.time_us, row.converged);
  }
  return text;
}

void write_matches(const std::filesystem::path& path, std::span<const MatchRow> rows) {
  write_whole_file(path, format_matches(rows));
}

std::vector<MatchRow> read_matches(const std::filesystem::path& path) {
  LineReader lines(open_bytes(path), path.string());
  std::string_view line;
  if (!lines.next(line) || line != kColumnNames) {
    throw DataError(lines.name(), 1, "this is no file of matches", kColumnNames);
  }
  std::vector<MatchRow> rows;
  Fields fields;
  while (lines.next(line)) {
    fields.split(line, lines, ',');
    if (fields.size() > 0) {
      lines.keep(sizeof(MatchRow));
      rows.push_back(parse_row(fields));
    }
  }
  return rows;
}

}  // namespace odoless
