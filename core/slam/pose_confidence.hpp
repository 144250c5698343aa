#pragma once

#include "core/base/parameters.hpp"

namespace odoless {

/// How fast trust in the pose goes and comes.
struct ConfidenceParams {
  double drift_per_m = 1e-3;
  double mend_per_s = 0.005;
  double against_fit = 0.75;
  double for_fit = 0.85;
  double evidence_per_fit = 5.0;
  double for_max = 0.25;
  double against_max = 1.0;
  double elsewhere = 3.0;
  double nowhere_else = 1.0;
  double evidence_period_s = 0.2;
  double found_probability = 0.5;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("drift_per_m", self.drift_per_m, Range{0.0, 1.0},
                "Probability per metre of travel that the error grows beyond what OK allows.");
    visit.value("mend_per_s", self.mend_per_s, Range{0.0, 10.0},
                "Rate at which the filter corrects a drifted pose, by closing loops.");
    visit.value("against_fit", self.against_fit, Range{0.0, 1.0},
                "Fit of a scan to the map, as a share of the usual fit, below which it is evidence against the pose.");
    visit.value("for_fit", self.for_fit, Range{0.0, 1.0},
                "Fit of a scan to the map, as a share of the usual fit, above which it is evidence for the pose.");
    visit.value("evidence_per_fit", self.evidence_per_fit, Range{0.0, 100.0},
                "Evidence, as logarithm of the odds, per unit of that share.");
    visit.value("for_max", self.for_max, Range{0.0, 10.0},
                "Largest evidence of one scan for the pose; the evidence of successive scans is correlated.");
    visit.value("against_max", self.against_max, Range{0.0, 10.0}, "Largest evidence of one scan against the pose.");
    visit.value("elsewhere", self.elsewhere, Range{0.0, 20.0},
                "Evidence against the pose where global localisation finds another pose, and only that one.");
    visit.value("nowhere_else", self.nowhere_else, Range{0.0, 20.0},
                "Evidence for the pose where global localisation finds no other pose; small, because the map may lack "
                "the right place.");
    visit.value("evidence_period_s", self.evidence_period_s, Range{0.001, 10.0},
                "Time that a scan stands for; scans at a higher rate count less, by their share of it.");
    visit.value("found_probability", self.found_probability, Range{0.01, 0.99},
                "Probability that a pose is right just after relocalisation.");
  }
};

/// Probability that the pose is right, as a hidden Markov model [rabiner1989hmm; method 8] of three states: the pose is
/// right; it drifted beyond what OK allows, while tracking goes on, which the filter mends by itself when a loop
/// closes; or it jumped, which only relocalisation mends. A step that is not certain to be right leads to the third
/// state; each scan that is compared with the map is evidence for the first or against it.
///
/// Thread: owned by one thread. Real time: no allocation, constant time.
class PoseConfidence {
 public:
  explicit PoseConfidence(const ConfidenceParams& params) : params_(params) {}

  /// The pose is known.
  void reset() { *this = PoseConfidence(params_); }
  /// The robot was relocalised.
  void find();
  /// The whole map was searched, and no other pose fits.
  void confirm();
  /// The whole map was searched, and another pose alone fits.
  void contradict();
  /// Nothing of the map will confirm the pose.
  void lose_track();

  /// @param step_probability  That the motion since the last scan is right within what OK allows.
  void move(double step_probability, double travel_m, double period_s);
  /// The motion up to here was only known so well: that it is within what OK allows has this probability.
  void slip(double within);
  /// @param fit_share    Fit of the scan in what the map knows, over the usual one.
  /// @param known_share  Share of the scan's beams that the map says anything of.
  /// @param span_s       Time that the scan stands for.
  /// @param moved        Since the scan before: 1 where all is seen from elsewhere, 0 at rest.
  void observe(double fit_share, double known_share, double span_s, double moved);

  /// Probabilities; with that of a drifted pose they sum to 1.
  [[nodiscard]] double right() const { return right_; }
  [[nodiscard]] double jumped() const { return jumped_; }
  /// That a step of about the last minute was wrong, whatever the scans say: what speaks for a place that the steps do
  /// not lead to.
  [[nodiscard]] double wrong_step() const { return wrong_step_; }

 private:
  void normalise();

  ConfidenceParams params_;
  double right_ = 1.0;
  double drifted_ = 0.0;
  double jumped_ = 0.0;
  double wrong_step_ = 0.0;
};

}  // namespace odoless
