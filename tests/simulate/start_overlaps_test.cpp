#include "simulate/start_overlaps.h"

#include <gmock/gmock.h>

#include "collision/separation.h"
#include "experiments/experiment.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
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

struct Start {
  VectorX state;
  std::vector<std::string> warnings;
  std::vector<Contact> contacts;  // nearer than 1 cm
};

/// Of a scene of one island.
Start startOf(const std::string& bodies) {
  const Scene scene =
      sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "t", "duration": 0.01, "bodies": [{}]}})", bodies));
  std::vector<Assembly> islands;
  for (const IslandPlan& island : planOf(scene).islands) islands.push_back(assemble(scene, island));
  correctStartPenetrations(scene, islands);
  Start start{islands.at(0).state, islands[0].warnings, {}};
  findContacts(islands[0].geometry, start.state, 0.01, start.contacts);
  return start;
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
  const std::string refusal = refusalOf(all({ball("a", 0), ball("b", 0.14)}));
  EXPECT_THAT(refusal, HasSubstr("experiment.json:3:1 /bodies/1: \"a\" and \"b\" overlap by 60 mm at the start"));
  EXPECT_THAT(refusal, HasSubstr("move them apart"));
}

TEST(StartOverlaps, OfEveryKindOfPairAreFound) {
  EXPECT_THAT(refusalOf(all({ball("a", 0), box("crate", 0.5)})), HasSubstr("overlap by 100 mm"));
  EXPECT_THAT(refusalOf(all({box("crate", 0), box("other", 0.7)})), HasSubstr("overlap by 300 mm"));
  EXPECT_THAT(refusalOf(all({box("crate", 0, R"(, "motion": "static")"), ball("inside", 0)})),
              HasSubstr("overlap by 600 mm"));
  // A cube of 1 m with its centre in the ground's surface, and one far below it.
  EXPECT_THAT(refusalOf(all({kGround, box("crate", 0)})), HasSubstr(R"("crate" is 500 mm deep in the plane "ground")"));
  EXPECT_THAT(refusalOf(all({ball("a", 0), R"({"name": "roof", "shape": {"plane": {}}, "motion": "static",
    "position": [0, 2, 0]})"})),
              HasSubstr(R"("a" is 2.1 m deep in the plane "roof")"));
}

TEST(StartOverlaps, AreToldAllAtOnceButNoMoreThanFifty) {
  EXPECT_THAT(refusalOf(all({ball("a", 0), ball("b", 0.13), ball("c", 0.26)})),
              testing::AllOf(HasSubstr("\"a\" and \"b\""), HasSubstr("\"b\" and \"c\""), Not(HasSubstr("more"))));
  // 12 balls in one place are 66 pairs.
  const std::string many = refusalOf(ball("a", 0, R"(, "copies": {"count": [12, 1, 1], "spacing": [0, 0, 0]})"));
  EXPECT_EQ(std::count(many.begin(), many.end(), '\n'), 50);
  EXPECT_THAT(many, HasSubstr("\nand 16 more"));
}

// 50 balls in one place are 1225 pairs, 18000 in a block that are 1 mm deep in each other some 53000.
TEST(StartOverlaps, AreCountedUpToAThousandAndMendedUpToFiftyThousand) {
  EXPECT_THAT(refusalOf(ball("a", 0, R"(, "copies": {"count": [50, 1, 1], "spacing": [0, 0, 0]})")),
              HasSubstr("\nand at least 950 more"));
  const std::string block =
      refusalOf(ball("a", 0, R"(, "copies": {"count": [30, 30, 20], "spacing": [0.199, 0.199, 0.199]})"));
  EXPECT_THAT(block, HasSubstr("overlap by 1 mm at the start; more pairs overlap than are moved apart"));
  EXPECT_THAT(block, HasSubstr("\nand at least 950 more"));
}

// 1e-9 of the smaller body's radius, 0.1 m, is touching.
TEST(StartOverlaps, UpToABillionthOfTheSmallerBodyAreTouching) {
  EXPECT_EQ(refusalOf(all({ball("a", 0), ball("b", 0.2 - 0.9e-10)})), "");
  EXPECT_THAT(startOf(all({ball("a", 0), ball("b", 0.2 - 0.9e-10)})).warnings, IsEmpty());
  EXPECT_THAT(startOf(all({ball("a", 0), ball("b", 0.2 - 1.1e-10)})).warnings,
              ElementsAre(HasSubstr("overlap by 1.1e-07 mm at the start; they were moved apart")));
  EXPECT_THAT(startOf(all({ball("a", 0), box("crate", 0.6 - 0.9e-10)})).warnings, IsEmpty());
  EXPECT_THAT(startOf(all({ball("a", 0), box("crate", 0.6 - 1.1e-10)})).warnings,
              ElementsAre(HasSubstr("overlap by 1.1e-07 mm")));
}

// Two balls of 1 and 3 kg that overlap by 40 mm part by 30 and 10: their centre of mass stays. A crate 0.2 m in the
// ground comes up by that.
TEST(StartOverlaps, UpToHalfTheInnerRadiusAreMovedApart) {
  const Start balls = startOf(all({ball("a", 0, R"(, "mass": 1)"), ball("b", 0.16, R"(, "mass": 3)")}));
  EXPECT_THAT(balls.warnings, ElementsAre(HasSubstr("\"a\" and \"b\" overlap by 40 mm at the start")));
  EXPECT_NEAR(centerOfMass(balls.state, 0).x(), -0.03, 1e-12);
  EXPECT_NEAR(centerOfMass(balls.state, 1).x(), 0.17, 1e-12);

  const Start crate = startOf(all({kGround, R"({"name": "crate", "shape": {"box": {"size": [1, 1, 1]}},
    "position": [0, 0.3, 0]})"}));
  EXPECT_THAT(crate.warnings, ElementsAre(HasSubstr("\"crate\" is 200 mm deep in the plane \"ground\"")));
  EXPECT_NEAR(centerOfMass(crate.state, 0).y(), 0.5, 1e-12);
}

/// Bodies of 1 and 4 kg that overlap beside their centres.
struct Eccentric {
  const char *a, *b;       // shapes
  Vec3 offset, direction;  // m: from a to b; in which they part
  double depth;            // m
};

// The direction of least overlap is that of the sides, or of the line between the centres; the overlap is shared as
// 4 to 1. Nothing asks for a turn.
TEST(StartOverlaps, AreTakenOutByInverseMassWithoutATurn) {
  const char* const cube = R"({"box": {"size": [1, 1, 1]}})";
  const char* const plate = R"({"box": {"size": [2, 0.4, 1]}})";
  const char* const ball = R"({"sphere": {"radius": 0.5}})";
  const char* const tube = R"({"cylinder": {"radius": 0.5, "length": 1}})";
  for (const Eccentric& pair : {
           Eccentric{cube, cube, {0.9, 0.4, 0}, {1, 0, 0}, 0.1},
           Eccentric{cube, cube, {0.9, 0, 0}, {1, 0, 0}, 0.1},
           Eccentric{cube, cube, {0.3, -0.999, 0.45}, {0, -1, 0}, 1e-3},
           Eccentric{plate, cube, {1.2, 0.65, -0.7}, {0, 1, 0}, 0.05},
           Eccentric{cube, ball, {0.4, 0.3, 0.9}, {0, 0, 1}, 0.1},
           Eccentric{tube, cube, {0.3, 0.92, 0.3}, {0, 1, 0}, 0.08},
           Eccentric{ball, ball, {0.57, 0.76, 0}, {0.6, 0.8, 0}, 0.05},
       }) {
    const Start start = startOf(all({fmt::format(R"({{"name": "a", "mass": 1, "shape": {}}})", pair.a),
                                     fmt::format(R"({{"name": "b", "mass": 4, "shape": {}, "position": [{}, {}, {}]}})",
                                                 pair.b, pair.offset.x(), pair.offset.y(), pair.offset.z())}));
    ASSERT_THAT(start.warnings, ElementsAre(HasSubstr("they were moved apart before the run")));
    EXPECT_LT((centerOfMass(start.state, 0) + 0.8 * pair.depth * pair.direction).norm(), 1e-9) << pair.a << pair.b;
    EXPECT_LT((centerOfMass(start.state, 1) - pair.offset - 0.2 * pair.depth * pair.direction).norm(), 1e-9)
        << pair.a << pair.b;
    for (int body = 0; body < 2; ++body)
      EXPECT_LT(orientation(start.state, body).vec().norm(), 1e-15) << pair.a << pair.b;
  }
}

// The body that moves alone takes all of it, tilted too: the lowest corner of a cube of 1 m turned by 20 degrees is
// (cos 20 + sin 20) / 2 below its centre.
TEST(StartOverlaps, WithWhatIsFixedMoveOneBodyAlone) {
  const Start shelf = startOf(all({box("shelf", 0, R"(, "motion": "static")"), R"({"name": "a", "position":
    [0.4, 0.95, 0.3], "shape": {"box": {"size": [1, 1, 1]}}})"}));
  EXPECT_LT((centerOfMass(shelf.state, 0) - Vec3(0.4, 1, 0.3)).norm(), 1e-12);
  EXPECT_LT(orientation(shelf.state, 0).vec().norm(), 1e-15);

  const double angle = 20 * 3.14159265358979324 / 180, reach = (std::cos(angle) + std::sin(angle)) / 2;
  const Start tilted = startOf(all({kGround, R"({"name": "a", "position": [0, 0.5, 0], "orientation":
    {"axis": [0, 0, 1], "angleDegrees": 20}, "shape": {"box": {"size": [1, 1, 1]}}})"}));
  EXPECT_LT((centerOfMass(tilted.state, 0) - Vec3(0, reach, 0)).norm(), 1e-12);
  EXPECT_NEAR(orientation(tilted.state, 0).z(), std::sin(angle / 2), 1e-14);
}

// Three equal cubes in a row, each 0.06 m deep in the next: the outer ones move by 0.06, the least that parts them.
TEST(StartOverlaps, OfARowPartWithTheCentreOfMassWhereItWas) {
  const Start start = startOf(all({box("a", 0), box("b", 0.94), box("c", 1.88)}));
  EXPECT_THAT(start.warnings, testing::SizeIs(2));
  EXPECT_LT((centerOfMass(start.state, 0) - Vec3(-0.06, 0, 0)).norm(), 1e-8);
  EXPECT_LT((centerOfMass(start.state, 1) - Vec3(0.94, 0, 0)).norm(), 1e-8);
  EXPECT_LT((centerOfMass(start.state, 2) - Vec3(1.94, 0, 0)).norm(), 1e-8);
  for (int body = 0; body < 3; ++body) EXPECT_LT(orientation(start.state, body).vec().norm(), 1e-15);
}

// A ball on a rod of 1 m reaches 40 mm into a wall: the rod lets it go aside on its circle alone, and keeps its length.
TEST(StartOverlaps, OfBodiesOnRodsAndJointsKeepTheirTies) {
  for (const char* tie : {R"("rods": [{"bodyA": "a", "anchorB": [0.3, 1, 0], "length": 1}])",
                          R"("ballJoints": [{"bodyA": "a", "anchorA": [0, 1, 0], "anchorB": [0.3, 1, 0]}])",
                          R"("hinges": [{"bodyA": "a", "anchorA": [0, 1, 0], "anchorB": [0.3, 1, 0],
                              "axis": [0, 0, 1]}])"}) {
    const Scene scene = sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "t", "duration": 0.01,
      "bodies": [{}, {}], {}}})",
                                            box("wall", -0.26, R"(, "motion": "static")"), ball("a", 0.3), tie));
    std::vector<Assembly> islands;
    for (const IslandPlan& island : planOf(scene).islands) islands.push_back(assemble(scene, island));
    correctStartPenetrations(scene, islands);
    Assembly& island = islands.at(0);
    EXPECT_THAT(island.warnings, ElementsAre(HasSubstr("overlap by 40 mm")));
    const Vec3 center = centerOfMass(island.state, 0);
    EXPECT_NEAR(center.x(), 0.34, 1e-8) << tie;
    EXPECT_NEAR((center - Vec3(0.3, 1, 0)).norm(), 1, 1e-12) << tie;
    ConstraintSolver ties(island.mechanism.constraints, island.mechanism.bodies);
    ties.factorize(island.state);
    EXPECT_LT(ties.largestError(), 1e-12) << tie;
  }
}

// Elastic balls of 1 and 3 kg that overlap by 40 mm, without gravity: whatever method moves them, they part by 30
// and 10.
TEST(StartOverlaps, OfBallsThatLoseNothingAreMovedApart) {
  const std::string hard = R"(, "material": "hard", "mass": )";
  const Scene scene = sceneOf(R"({"schema": "cradle-scene/1", "name": "t", "duration": 0.01, "gravity": [0, 0, 0],
    "materials": {"hard": {"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}, "bodies": [)" +
                              all({ball("a", 0, hard + "1"), ball("b", 0.16, hard + "3")}) + "]}");
  ASSERT_EQ(planOf(scene).islands.at(0).method.kind, MotionKind::elasticFlight);
  const Frame start = simulate(scene).frames.at(0);
  EXPECT_NEAR(start.states[0].position.x(), -0.03, 1e-9);
  EXPECT_NEAR(start.states[1].position.x(), 0.17, 1e-9);
}

// What overlapped lies still afterwards: nothing was thrown out of anything. The crate lost no height to the count.
TEST(StartOverlaps, AreMendedWithoutAJumpInEnergy) {
  for (const char* accuracy : {"1e-3", "1e-6"}) {
    const Trajectory balls = simulate(sceneOf(
        fmt::format(R"({{"schema": "cradle-scene/1", "name": "t", "duration": 0.2,
      "accuracy": {}, "gravity": [0, 0, 0], "materials": {{"m": {{"restitution": 1}}}}, "bodies": [{}]}})",
                    accuracy, all({ball("a", 0, R"(, "material": "m")"), ball("b", 0.16, R"(, "material": "m")")}))));
    for (const Frame& frame : balls.frames) EXPECT_EQ(frame.energy.kinetic, 0) << accuracy;
    const Trajectory crate = simulate(sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "t", "duration": 0.2,
      "accuracy": {}, "bodies": [{}, {}]}})",
                                                          accuracy, kGround, R"({"name": "crate", "mass": 1,
      "shape": {"box": {"size": [1, 1, 1]}}, "position": [0, 0.3, 0]})")));
    for (const Frame& frame : crate.frames) {
      EXPECT_NEAR(frame.energy.kinetic + frame.energy.potential, 9.81 * 0.5, 1e-9) << accuracy;
      EXPECT_NEAR(frame.energy.dissipated, 0, 1e-9) << accuracy;
    }
  }
}

TEST(StartOverlaps, OfEveryShapeAreMovedApart) {
  for (const char* shape :
       {R"({"cylinder": {"radius": 0.3, "length": 1}})", R"({"capsule": {"radius": 0.3, "length": 1}})",
        R"({"box": {"size": [0.6, 1, 0.6]}})", R"({"sphere": {"radius": 0.3}})"})
    for (const char* other : {R"({"cylinder": {"radius": 0.2, "length": 2}})",
                              R"({"capsule": {"radius": 0.2, "length": 2}})", R"({"box": {"size": [0.4, 2, 0.4]}})"}) {
      const Start start = startOf(all({fmt::format(R"({{"name": "a", "shape": {}}})", shape),
                                       fmt::format(R"({{"name": "b", "shape": {}, "position": [0.46, 0.1, 0.05],
        "orientation": {{"axis": [0, 0, 1], "angleDegrees": 3}}}})",
                                                   other)}));
      EXPECT_THAT(start.warnings, ElementsAre(HasSubstr("they were moved apart before the run"))) << shape << other;
      EXPECT_THAT(start.contacts, Not(IsEmpty()));
      for (const Contact& contact : start.contacts) EXPECT_GT(contact.separation, -1e-9) << shape << other;
    }
}

TEST(StartOverlaps, ThatNothingCanMendAreRefused) {
  // A ball 10 mm too wide for the gap between two walls.
  EXPECT_THAT(refusalOf(all({box("left", -0.595, R"(, "motion": "static")"), ball("a", 0),
                             box("right", 0.595, R"(, "motion": "static")")})),
              HasSubstr("overlap by 5 mm at the start, and what is around holds them together: mend"));
  // Boxes that a hinge with `collide` keeps where they are: as deep as they were, whatever was tried.
  EXPECT_THAT(refusalOf(R"({"name": "a", "shape": {"box": {"size": [1, 0.2, 0.2]}}, "position": [0, 2, 0]},
      {"name": "b", "shape": {"box": {"size": [1, 0.2, 0.2]}}, "position": [0.98, 2, 0]})",
                        R"(, "hinges": [{"bodyA": "a", "bodyB": "b", "anchorA": [0.49, 0, 0], "anchorB": [-0.49, 0, 0],
      "collide": true}])"),
              HasSubstr("overlap by 20 mm"));
}

// Two balls of 0.1 m whose overlap of 20 mm moves each by 10 mm; a slider or a rope leaves the second one less, or
// more.
TEST(StartOverlaps, ThatOnlyALimitCouldMendAreRefused) {
  const std::string balls = ball("a", 0, R"(, "motion": "static")") + ", " + ball("b", 0.18);
  const auto slider = [](const char* upper) {
    return fmt::format(
        R"(, "sliders": [{{"bodyA": "b", "anchorA": [0, 0, 0], "anchorB": [0.18, 0, 0], "axis": [1, 0, 0],
        "limits": {{"lower": -1, "upper": {}}}}}])",
        upper);
  };
  const auto rope = [](const char* length) {
    return fmt::format(R"(, "ropes": [{{"bodyA": "b", "anchorA": [0, 0, 0], "anchorB": [-1, 0, 0], "maxLength": {}}}])",
                       length);
  };
  EXPECT_EQ(refusalOf(balls, slider("0.021")), "");
  EXPECT_THAT(refusalOf(balls, slider("0.019")), HasSubstr("\"b\" overlaps what it touches"));
  EXPECT_THAT(refusalOf(balls, slider("0.019")), HasSubstr("beyond a limit of its joint"));
  EXPECT_EQ(refusalOf(balls, rope("1.21")), "");
  EXPECT_THAT(refusalOf(balls, rope("1.19")), HasSubstr("beyond the length of its rope"));
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
    EXPECT_THAT(refusalOf(all({ball("a", 0), ball("b", 0.13)}), fmt::format(", {}", text)),
                HasSubstr("overlap by 70 mm"))
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
  EXPECT_THAT(refusalAt(0.1499), HasSubstr("\"cube\" is 150.1 mm deep"));
}

// The middle of the bounds of a pyramid over three edges of 1 m is outside of it; the mean of its corners is 0.25 /
// sqrt(3) m from the slope. What may be mended is half of that.
TEST(StartOverlaps, OfWhatIsNotInTheMiddleOfItsBoundsHaveALimitToo) {
  const auto refusalAt = [](double height) -> std::string {
    const Scene scene = parseScene(fmt::format(R"({{"schema": "cradle-scene/1", "name": "t", "duration": 0.01,
      "bodies": [{}, {{"name": "pyramid", "shape": {{"mesh": "pyramid.obj"}}, "position": [0, {}, 0]}}]}})",
                                               kGround, height),
                                   "experiment.json",
                                   [](const MeshReference&) {
                                     TriangleMesh pyramid;
                                     pyramid.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
                                     pyramid.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
                                     return LoadedModel{{"pyramid", pyramid, {}}, {}};
                                   })
                            .scene;
    try {
      simulate(scene);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusalAt(-0.07), "");
  EXPECT_THAT(refusalAt(-0.08), HasSubstr("\"pyramid\" is 80 mm deep in the plane \"ground\" at the start; at most "
                                          "72.17 mm, half of the radius inside"));
}

}  // namespace
}  // namespace cradle
