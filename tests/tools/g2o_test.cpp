// Pose graphs as files, and the command that solves them.
#include "tools/output/g2o.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

using test::Outcome;
using test::run;
using ::testing::HasSubstr;

constexpr const char* kSquare =
    "# a square of 4 m, whose last side is measured 0.4 m too long\n"
    "VERTEX_SE2 10 0 0 0\n"
    "VERTEX_SE2 11 4 0 1.5708\n"
    "VERTEX_SE2 12 4 4 3.1416\n"
    "VERTEX_SE2 13 0 4 -1.5708\n"
    "FIX 10\n"
    "EDGE_SE2 10 11 4 0 1.5707963 100 0 0 100 0 1000\n"
    "EDGE_SE2 11 12 4 0 1.5707963 100 0 0 100 0 1000\n"
    "EDGE_SE2 12 13 4 0 1.5707963 100 0 0 100 0 1000\n"
    "EDGE_SE2 13 10 4.4 0 1.5707963 100 0 0 100 0 1000\n";

TEST(G2o, ReadsBackWhatItWrote) {
  const test::TemporaryFolder folder;
  const PoseGraph graph = read_g2o(folder.file("a.g2o", kSquare));
  ASSERT_EQ(graph.size(), 4);
  ASSERT_EQ(graph.constraints().size(), 4U);
  EXPECT_TRUE(graph.constraints()[3].is_loop);
  EXPECT_FALSE(graph.constraints()[0].is_loop);
  const std::string text = format_g2o(graph);
  EXPECT_EQ(format_g2o(read_g2o(folder.file("b.g2o", text))), text);
}

TEST(G2o, KeepsTheInformationMatrixAsItWas) {
  const test::TemporaryFolder folder;
  const std::string edge = "EDGE_SE2 0 1 1 2 0.5 10 1 2 20 3 30";
  const PoseGraph graph = read_g2o(folder.file("a.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 2 0.5\n" + edge + "\n"));
  EXPECT_THAT(format_g2o(graph), HasSubstr("EDGE_SE2 0 1 1.000000 2.000000 0.500000000 10 1 2 20 3 30\n"));
}

TEST(G2o, RefusesWhatIsNoGraphWithItsLine) {
  const test::TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      static_cast<void>(read_g2o(folder.file("a.g2o", text)));
    } catch (const DataError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string two = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n";
  EXPECT_THAT(refusal(""), HasSubstr("no vertex"));
  EXPECT_THAT(refusal("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"), HasSubstr(":1: an unknown tag"));
  EXPECT_THAT(refusal(two + "VERTEX_SE2 1 0 0 0\n"), HasSubstr(":3: a vertex that was there before"));
  EXPECT_THAT(refusal(two + "EDGE_SE2 0 7 0 0 0 1 0 0 1 0 1\n"),
              HasSubstr(":3: an edge of a vertex that is not there"));
  EXPECT_THAT(refusal(two + "EDGE_SE2 0 1 0 0 0 1 0 0 -1 0 1\n"), HasSubstr("not positive definite"));
  EXPECT_THAT(refusal(two + "EDGE_SE2 0 0 0 0 0 1 0 0 1 0 1\n"), HasSubstr("from a vertex to itself"));
  EXPECT_THAT(refusal(two + "EDGE_SE2 0 1 0 0\n"), HasSubstr(":3:"));
  EXPECT_THAT(refusal("VERTEX_SE2 0 nan 0 0\n"), HasSubstr(":1:"));
}

TEST(G2o, SolveSpreadsAnErrorOverTheSquare) {
  const test::TemporaryFolder folder;
  const auto in = folder.file("in.g2o", kSquare);
  const auto out = folder.path() / "out.g2o";
  const Outcome done = run({"graph", "solve", in.string(), "--out", out.string()});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("4 vertices, 4 edges"));
  const PoseGraph solved = read_g2o(out);
  // Both sides take a part of the 0.4 m, and the turns the rest.
  EXPECT_NEAR(solved.pose(1).x_m, 4.0, 0.05);
  EXPECT_GT(solved.pose(3).y_m, 4.1);
  EXPECT_LT(solved.pose(3).y_m, 4.4);
  EXPECT_GT(solved.pose(2).y_m, 4.02);
  EXPECT_EQ(solved.pose(0).x_m, 0.0);
}

TEST(G2o, SolveSaysWhatIsWrongWithItsFile) {
  EXPECT_EQ(run({"graph", "solve", "/does/not/exist.g2o"}).status, 66);
  const test::TemporaryFolder folder;
  EXPECT_EQ(run({"graph", "solve", folder.file("a.g2o", "hello\n").string()}).status, 65);
  EXPECT_EQ(run({"graph"}).status, 64);
}

}  // namespace
}  // namespace odoless
