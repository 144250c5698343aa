#include "tools/eval/report.hpp"

#include <fmt/core.h>

namespace odoless {
namespace {

using Json = nlohmann::ordered_json;

Statistics in_degrees(const Statistics& rad) {
  return {.count = rad.count,
          .mean = to_deg(rad.mean),
          .deviation = to_deg(rad.deviation),
          .root_mean_square = to_deg(rad.root_mean_square),
          .median = to_deg(rad.median),
          .percentile_99 = to_deg(rad.percentile_99),
          .max = to_deg(rad.max)};
}

Json to_json(const Statistics& statistics) {
  return {{"rmse", statistics.root_mean_square},
          {"mean", statistics.mean},
          {"sd", statistics.deviation},
          {"median", statistics.median},
          {"max", statistics.max}};
}

Json to_json(const PoseErrorStatistics& errors) {
  return {{"translation_m", to_json(errors.translation_m)}, {"rotation_deg", to_json(in_degrees(errors.rotation_rad))}};
}

std::string to_text(const char* name, const char* unit, const Statistics& s) {
  return fmt::format("{:<16} rmse {:.4f}, mean {:.4f} +- {:.4f}, median {:.4f}, max {:.4f} {}", name,
                     s.root_mean_square, s.mean, s.deviation, s.median, s.max, unit);
}

std::string to_text(const PoseErrorStatistics& errors) {
  return fmt::format("{}\n{}", to_text("translation", "m", errors.translation_m),
                     to_text("rotation", "deg", in_degrees(errors.rotation_rad)));
}

std::string counts_text(const char* what, std::size_t used, std::size_t missing) {
  return fmt::format("{:<16} {} used, {} missing", what, used, missing);
}

std::string to_text(const RelationsResult& result) {
  return fmt::format("{:<16} {} within {} s, {} of them off by more than {} m or {} deg\n", "one visit",
                     result.one_visit.used, kOneVisit_s, result.one_visit.off, kOffOnOneVisit.translation_m,
                     to_deg(kOffOnOneVisit.rotation_rad)) +
         fmt::format("{:<16} {}, {} of them off by more than {} m", "across loops", result.across_loops.used,
                     result.across_loops.off, kOffAcrossALoop_m);
}

Json to_json(const PairError& pair) {
  return {{"reference_index", pair.row.reference_index},
          {"index", pair.row.index},
          {"stamp_s", pair.row.stamp_s},
          {"translation_m", pair.error.translation_m},
          {"rotation_deg", to_deg(pair.error.rotation_rad)},
          {"fitness", pair.row.fitness},
          {"converged", pair.row.converged}};
}

std::string to_text(const PairError& pair) {
  return fmt::format("  {:>6} to {:>6} at {:.3f} s: {:.3f} m, {:.2f} deg, fitness {:.3f}{}", pair.row.reference_index,
                     pair.row.index, pair.row.stamp_s, pair.error.translation_m, to_deg(pair.error.rotation_rad),
                     pair.row.fitness, pair.row.converged ? "" : ", not converged");
}

double gross_percent(const PairsResult& result) {
  return result.used > 0 ? 100.0 * static_cast<double>(result.gross) / static_cast<double>(result.used) : 0.0;
}

std::string to_text(const PairsResult& result) {
  const Statistics& time_us = result.time_us;
  std::string text = counts_text("matches", result.used, result.missing);
  text += fmt::format("\n{}", to_text(result.errors));
  text += fmt::format("\n{:<16} {} ({:.3f} %); rmse of the others {:.4f} m, {:.4f} deg", "gross failures", result.gross,
                      gross_percent(result), result.errors_of_good.translation_m.root_mean_square,
                      to_deg(result.errors_of_good.rotation_rad.root_mean_square));
  text += fmt::format("\n{:<16} {:.2f} %", "converged", 100.0 * result.converged_share);
  text += fmt::format("\n{:<16} median {:.0f}, p99 {:.0f}, max {:.0f} us\nworst", "time", time_us.median,
                      time_us.percentile_99, time_us.max);
  for (const PairError& pair : result.worst) {
    text += fmt::format("\n{}", to_text(pair));
  }
  return text;
}

}  // namespace

Report report(const RelationsResult& result) {
  Json json{{"metric", "relations"}, {"used", result.used}, {"missing", result.missing}};
  json.update(to_json(result.errors));
  json["one_visit"] = {{"used", result.one_visit.used},
                       {"off", result.one_visit.off},
                       {"within_s", kOneVisit_s},
                       {"off_above_m", kOffOnOneVisit.translation_m},
                       {"off_above_deg", to_deg(kOffOnOneVisit.rotation_rad)}};
  json["across_loops"] = {
      {"used", result.across_loops.used}, {"off", result.across_loops.off}, {"off_above_m", kOffAcrossALoop_m}};
  return {fmt::format("{}\n{}\n{}", counts_text("relations", result.used, result.missing), to_text(result.errors),
                      to_text(result)),
          json};
}

Report report(const AteResult& result) {
  const Pose2& fit = result.reference_T_estimate;
  Json json{{"metric", "ate"}, {"used", result.used}, {"missing", result.missing}};
  json.update(to_json(result.errors));
  json["alignment"] = {{"x_m", fit.x_m}, {"y_m", fit.y_m}, {"yaw_deg", to_deg(fit.yaw_rad)}};
  return {fmt::format("{}\n{}", counts_text("poses", result.used, result.missing), to_text(result.errors)), json};
}

Report report(const PairsResult& result) {
  Json json{{"metric", "pairs"}, {"used", result.used}, {"missing", result.missing}};
  json.update(to_json(result.errors));
  json["gross_failures"] = result.gross;
  json["gross_percent"] = gross_percent(result);
  json["without_gross"] = to_json(result.errors_of_good);
  json["converged_share"] = result.converged_share;
  json["time_us"] = {
      {"median", result.time_us.median}, {"p99", result.time_us.percentile_99}, {"max", result.time_us.max}};
  json["worst"] = Json::array();
  for (const PairError& pair : result.worst) {
    json["worst"].push_back(to_json(pair));
  }
  return {to_text(result), json};
}

}  // namespace odoless
