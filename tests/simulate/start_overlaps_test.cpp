#include "simulate/start_overlaps.h"

#include <gmock/gmock.h>

#include "experiments/experiment.h"

namespace cradle {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string refusalOf(const std::string& bodies, const std::string& more = "") {
  const Scene scene = sceneOf(
      fmt::format(R"({{"schema": "cradle-scene/1", "name": "t", "duration": 0.01, "bodies": [{}]{}}})", bodies, more));
  try {
    simulate(scene);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::scene) << error.what();
    return error.what();
  }
  return "";
}

std::string ball(const std::string& name, double x, const std::string& more = "") {
  return fmt::format(R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "position": [{:.17g}, 0, 0]{}}})",
                     name, x, more);
}
std::string box(const std::string& name, double x, const std::string& more = "") {
  return fmt::format(R"({{"name": "{}", "shape": {{"box": {{"size": [1, 1, 1]}}}}, "position": [{:.17g}, 0, 0]{}}})",
                     name, x, more);
}
/// Bodies, one a line, the first on line 2.
std::string all(const std::vector<std::string>& bodies) {
  return fmt::format("\n{}", fmt::join(bodies, ",\n"));
}
const char* const kGround = R"({"name": "ground", "shape": {"plane": {}}, "motion": "static"})";

TEST(StartOverlaps, AreToldWithBothBodiesDepthAndPlace) {
  const std::string refusal = refusalOf(all({ball("a", 0), ball("b", 0.18)}));
  EXPECT_THAT(refusal, HasSubstr("experiment.json:3:1 /bodies/1: \"a\" and \"b\" overlap by 20 mm at the start"));
  EXPECT_THAT(refusal, HasSubstr("move them apart"));
}

TEST(StartOverlaps, OfEveryKindOfPairAreFound) {
  EXPECT_THAT(refusalOf(all({ball("a", 0), box("crate", 0.55)})), HasSubstr("overlap by 50 mm"));
  EXPECT_THAT(refusalOf(all({box("crate", 0), box("other", 0.75)})), HasSubstr("overlap by 250 mm"));
  EXPECT_THAT(refusalOf(all({box("crate", 0, R"(, "motion": "static")"), ball("inside", 0)})),
              HasSubstr("overlap by 600 mm"));
  // A cube of 1 m with its centre in the ground's surface, and one far below it.
  EXPECT_THAT(refusalOf(all({kGround, box("crate", 0)})), HasSubstr(R"("crate" is 500 mm deep in the plane "ground")"));
  EXPECT_THAT(refusalOf(all({ball("a", 0), R"({"name": "roof", "shape": {"plane": {}}, "motion": "static",
    "position": [0, 2, 0]})"})),
              HasSubstr(R"("a" is 2.1 m deep in the plane "roof")"));
}

TEST(StartOverlaps, AreToldAllAtOnceButNoMoreThanFifty) {
  EXPECT_THAT(refusalOf(all({ball("a", 0), ball("b", 0.15), ball("c", 0.3)})),
              testing::AllOf(HasSubstr("\"a\" and \"b\""), HasSubstr("\"b\" and \"c\""), Not(HasSubstr("more"))));
  // 12 balls in one place are 66 pairs.
  const std::string many = refusalOf(ball("a", 0, R"(, "copies": {"count": [12, 1, 1], "spacing": [0, 0, 0]})"));
  EXPECT_EQ(std::count(many.begin(), many.end(), '\n'), 50);
  EXPECT_THAT(many, HasSubstr("\nand 16 more"));
}

// 1e-9 of the smaller body's radius, 0.1 m, is touching.
TEST(StartOverlaps, UpToABillionthOfTheSmallerBodyAreTouching) {
  EXPECT_EQ(refusalOf(all({ball("a", 0), ball("b", 0.2 - 0.9e-10)})), "");
  EXPECT_THAT(refusalOf(all({ball("a", 0), ball("b", 0.2 - 1.1e-10)})), HasSubstr("at most 1e-07 mm is touching"));
  EXPECT_EQ(refusalOf(all({ball("a", 0), box("crate", 0.6 - 0.9e-10)})), "");
  EXPECT_THAT(refusalOf(all({ball("a", 0), box("crate", 0.6 - 1.1e-10)})), HasSubstr("at most 1e-07 mm is touching"));
}

TEST(StartOverlaps, OfWhatCannotTouchDoNotMatter) {
  EXPECT_EQ(refusalOf(all({box("wall", 0, R"(, "motion": "static")"), box("floor", 0.5, R"(, "motion": "static")")})),
            "");
  EXPECT_EQ(refusalOf(all({kGround, box("wall", 0, R"(, "motion": "static")")})), "");
  EXPECT_EQ(refusalOf(all({ball("a", 0), ball("ghost", 0.1, R"(, "collision": "none")")})), "");
}

TEST(StartOverlaps, OfBodiesJoinedByRodsSpringsAndRopesMatter) {
  for (const char* link : {R"("rods": [{{{}}}])", R"("ropes": [{{{}}}])", R"("springs": [{{{}, "stiffness": 1}}])"}) {
    const std::string text =
        fmt::format(fmt::runtime(link), R"("bodyA": "a", "anchorA": [0, 0, 0], "bodyB": "b", "anchorB": [0, 0, 0])");
    EXPECT_THAT(refusalOf(all({ball("a", 0), ball("b", 0.15)}), fmt::format(", {}", text)),
                HasSubstr("overlap by 50 mm"))
        << text;
  }
}

// A cube whose corners a file holds in single precision, 0.3 as 0.30000001192..., set on the ground by the decimal.
TEST(StartOverlaps, OfModelsMayBeTheRoundingOfTheirFiles) {
  const auto refusalAt = [](double height) -> std::string {
    const Scene scene = parseScene(fmt::format(R"({{"schema": "cradle-scene/1", "name": "t", "duration": 0.01,
      "bodies": [{}, {{"name": "cube", "shape": {{"mesh": "cube.obj"}}, "position": [0, {:.17g}, 0]}}]}})",
                                               kGround, height),
                                   "experiment.json",
                                   [](const MeshReference&) {
                                     const DrawnMesh drawn = tessellate(Box{2.0 * Vec3::Constant(0.3F)});
                                     return LoadedModel{{"cube", weld(drawn.vertices, drawn.triangles), drawn}, {}};
                                   })
                            .scene;
    try {
      simulate(scene);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusalAt(0.3), "");
  EXPECT_THAT(refusalAt(0.2999), HasSubstr("\"cube\" is 0.1 mm deep"));
}

}  // namespace
}  // namespace cradle
