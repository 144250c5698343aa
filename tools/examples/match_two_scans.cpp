// The motion from the first scan of a file to the second one, without any guess of it: match_two_scans < SCANS.csv

#include <cmath>
#include <cstdio>
#include <iostream>

#include "core/match/ndt_matcher.hpp"
#include "tools/examples/scan_line.hpp"

using namespace odoless;  // NOLINT: an example

int main() {
  ScanFrame first{ScanParams{}};
  ScanFrame second{ScanParams{}};
  std::string line;
  for (ScanFrame* scan : {&first, &second}) {
    if (!std::getline(std::cin, line) || !ScanLine(line).write_to(*scan)) {
      std::cerr << "match_two_scans: needs two lines: scan,STAMP_S,START_RAD,STEP_RAD,,RANGE_M,...\n";
      return 65;
    }
  }

  const MatcherParams params;
  NdtMatcher matcher(params);
  MatchReference reference(params.reference, params.points_max);
  const PlacedScan placed{&first, {}};
  if (reference.rebuild({&placed, 1}) != Errc::kOk) {
    std::cerr << "match_two_scans: the first scan has too few returns\n";
    return 65;
  }
  Rng rng(1);
  const Result<MatchResult> match = matcher.match(reference, second, Expectation{}, Deadline{}, rng);
  if (!match.ok()) {
    std::cerr << "match_two_scans: " << describe(match.error()) << "\n";
    return 65;
  }
  const MatchResult& found = match.value();
  const Pose2& motion = found.reference_T_scan;
  std::printf("motion  %.4f m  %.4f m  %.4f rad\n", motion.x_m, motion.y_m, motion.yaw_rad);
  std::printf("sd      %.4f m  %.4f m  %.4f rad\n", std::sqrt(found.covariance(0, 0)),
              std::sqrt(found.covariance(1, 1)), std::sqrt(found.covariance(2, 2)));
  std::printf("%s, fitness %.2f, %d hypotheses\n", found.converged ? "converged" : "rejected or ambiguous",
              found.fitness, found.peak_count);
}
