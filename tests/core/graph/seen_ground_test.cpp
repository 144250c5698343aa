// The ground that keyframes have seen, against squares that can be counted by hand.
#include "core/graph/seen_ground.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

namespace odoless {
namespace {

/// A scan all around, of so many metres in each direction.
struct Around {
  explicit Around(float range_m) {
    constexpr int kAroundBeams = 360;
    const std::vector<float> ranges_m(kAroundBeams, range_m);
    ScanFrame scan(ScanParams{});
    EXPECT_EQ(scan.assign({.start_angle_rad = -std::numbers::pi,
                           .angle_step_rad = 2.0 * std::numbers::pi / kAroundBeams,
                           .ranges_m = ranges_m}),
              Errc::kOk);
    Keyframe keyframe;
    std::vector<BeamCode> codes(static_cast<std::size_t>(keyframe_beams(scan.size(), 541)));
    encode(scan, 541, keyframe, codes);
    store.add(keyframe, codes);
  }
  [[nodiscard]] SeenGround from(const Pose2& map_T_scan, int part = 0) const {
    SeenGround ground;
    ground.see(part, store, 0, map_T_scan);
    return ground;
  }

  KeyframeStore store{1, 541};
};

TEST(SeenGround, IsAllOfItselfAndNothingOfNothing) {
  const SeenGround ground = Around(4.0F).from({1.0, 2.0, 0.3});
  EXPECT_EQ(ground.share_in(ground), 1.0);
  EXPECT_EQ(ground.share_in(SeenGround()), 0.0);
  EXPECT_EQ(SeenGround().share_in(ground), 0.0) << "0 without any";
}

TEST(SeenGround, OfASmallerOneHasItsPartAndNotTheOtherWayRound) {
  const SeenGround large = Around(4.0F).from({});
  const SeenGround small = Around(2.0F).from({});
  EXPECT_EQ(small.share_in(large), 1.0);
  const double share = large.share_in(small);
  EXPECT_GT(share, 0.25);  // of a circle's area
  EXPECT_LT(share, 0.39);  // and a cell more at the edge, slanting
}

TEST(SeenGround, EndsAtSixMetres) {
  EXPECT_EQ(Around(20.0F).from({}).share_in(Around(6.0F).from({})), 1.0);
  EXPECT_LT(Around(20.0F).from({}).share_in(Around(5.0F).from({})), 0.85);
}

TEST(SeenGround, LiesWhereTheScanWas) {
  const Around around(3.0F);
  const SeenGround here = around.from({-40.0, 70.0, 0.0});
  EXPECT_EQ(here.share_in(around.from({-40.0, 70.0, 1.0})), 1.0);
  EXPECT_GT(here.share_in(around.from({-39.0, 70.0, 0.0})), 0.7);
  EXPECT_LT(here.share_in(around.from({-39.0, 70.0, 0.0})), 0.95);
  EXPECT_EQ(here.share_in(around.from({-33.0, 70.0, 0.0})), 0.0);
  EXPECT_EQ(here.share_in(around.from({40.0, 70.0, 0.0})), 0.0);
}

TEST(SeenGround, PartsOfAWorldAreApart) {
  const Around around(3.0F);
  EXPECT_EQ(around.from({}, 0).share_in(around.from({}, 1)), 0.0);
}

TEST(SeenGround, OfTwoHasWhatEitherHas) {
  const Around around(3.0F);
  SeenGround both = around.from({0.0, 0.0, 0.0});
  both.add(around.from({20.0, 0.0, 0.0}));
  EXPECT_EQ(around.from({0.0, 0.0, 0.0}).share_in(both), 1.0);
  EXPECT_EQ(around.from({20.0, 0.0, 0.0}).share_in(both), 1.0);
  EXPECT_NEAR(both.share_in(around.from({20.0, 0.0, 0.0})), 0.5, 1e-9);
}

}  // namespace
}  // namespace odoless
