#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <numbers>

#include "experiments/experiment.h"
#include "experiments/random_scene_figures.h"
#include "experiments/touching_places.h"
#include "math/rotation.h"
#include "study/drift_meter.h"

// Bodies whose joint is where they touch something: flaps, doors, lids, pendulums at walls, bodies that stand on a
// pinned corner, rim or round end. The contact at the joint is there for ever, and must hide no other.

namespace cradle {
namespace {

const std::string kPlane = R"({"name": "ground", "shape": {"plane": {}}, "motion": "static", "material": "m"})";
const std::string kBox =
    R"({"name": "ground", "shape": {"box": {"size": [4, 1, 4]}}, "position": [0, -0.5, 0], "motion": "static",
    "material": "m"})";
/// The flap's hinge is at its edge.
const std::string kBlockUnderFlap =
    R"({"name": "ground", "shape": {"box": {"size": [1, 1, 1]}}, "position": [0.5, -0.5, 0], "motion": "static",
    "material": "m"})";

std::string orientationText(const Quat& q) {
  return fmt::format(R"({{"w": {}, "x": {}, "y": {}, "z": {}}})", q.w(), q.x(), q.y(), q.z());
}

std::string materialsText(double restitution, double friction) {
  return fmt::format(R"("materials": {{"m": {{"restitution": {0}, "staticFriction": {1}, "dynamicFriction": {1}}}}})",
                     restitution, friction);
}

/// A box of 1 x 0.05 x 0.5 m, hinged by its lower left edge at a height `gap` (m) over the ground, open by an angle.
struct Flap {
  std::string ground = kPlane;
  double accuracy = 1e-6, gap = 0, angle = 60, friction = 0.5;  // -, m, degrees, -

  static constexpr double kThickness = 0.05;

  Quat turn(double degrees) const { return Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitZ())); }
  Vec3 edge() const { return {-0.5, -kThickness / 2, 0}; }
  /// rad: the angle at which the lower edge at its end touches the ground.
  double shut() const { return -std::asin(gap); }

  Trajectory run() const {
    const Quat open = turn(angle);
    return simulate(sceneWith(fmt::format(
        R"("duration": 2, "accuracy": {}, "output": {{"framesPerSecond": 100}}, {}, "bodies": [{}, {{"name": "flap",
        "shape": {{"box": {{"size": [1, {}, 0.5]}}}}, "material": "m", "position": {}, "orientation": {}}}],
        "hinges": [{{"bodyA": "flap", "anchorA": {}, "anchorB": [0, {}, 0]}}])",
        accuracy, materialsText(0, friction), ground, kThickness, vectorText(Vec3(0, gap, 0) - open * edge()),
        orientationText(open), vectorText(edge()), gap)));
  }
};

/// Lowest height (m) of the flap's corners.
double lowestCorner(const BodyState& state) {
  double lowest = INFINITY;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-Flap::kThickness / 2, Flap::kThickness / 2})
      for (const double z : {-0.25, 0.25})
        lowest = std::min(lowest, (state.position + state.orientation * Vec3(x, y, z)).y());
  return lowest;
}

struct FlapCase {
  const char* name;
  std::string ground;
  double gap, angle, friction;
};

class FlapOnGround : public testing::TestWithParam<FlapCase> {};

// Shut, the far lower edge lies on the ground: the angle is -asin(gap / 1 m). What is promised is the accuracy in parts
// of 1 + |x|; in a frame inside a step the corners keep the ground as the joint does.
TEST_P(FlapOnGround, LiesShutAtLast) {
  for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-8}) {
    Flap flap{GetParam().ground, accuracy, GetParam().gap, GetParam().angle, GetParam().friction};
    const Trajectory run = flap.run();
    const BodyState end = endOf(run);
    const Quat shut(Eigen::AngleAxisd(flap.shut(), Vec3::UnitZ()));
    const Vec3 place = Vec3(0, flap.gap, 0) - shut * flap.edge();
    EXPECT_LT((end.position - place).norm(), accuracy) << accuracy;
    EXPECT_LT(orientationError(end.orientation, shut), accuracy) << accuracy;
    EXPECT_EQ(end.linearVelocity.norm(), 0) << accuracy;
    for (const Frame& frame : run.frames) EXPECT_GT(lowestCorner(frame.states[0]), -0.1 * accuracy) << frame.time;
    for (std::size_t i = 1; i < run.frames.size(); ++i)
      EXPECT_GE(run.frames[i].energy.dissipated, run.frames[i - 1].energy.dissipated - accuracy) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Grounds, FlapOnGround,
                         testing::Values(FlapCase{"Plane", kPlane, 0, 60, 0.5},
                                         FlapCase{"PlaneWithoutFriction", kPlane, 0, 60, 0},
                                         FlapCase{"PlaneNearlyShut", kPlane, 0, 5, 0.5},
                                         FlapCase{"PlaneGapOfNanometre", kPlane, 1e-9, 60, 0.5},
                                         FlapCase{"PlaneGapOfMicrometre", kPlane, 1e-6, 60, 0.5},
                                         FlapCase{"PlaneGapOfMillimetre", kPlane, 1e-3, 60, 0.5},
                                         FlapCase{"Box", kBox, 0, 60, 0.5},
                                         FlapCase{"BoxGapOfMicrometre", kBox, 1e-6, 60, 0},
                                         FlapCase{"EdgeOfBlock", kBlockUnderFlap, 0, 60, 0.5},
                                         FlapCase{"EdgeOfBlockGapOfNanometre", kBlockUnderFlap, 1e-9, 80, 0.5}),
                         [](const auto& info) { return std::string(info.param.name); });

// A capsule hinged by the centre of its upper cap, which touches the wall all the time. Between impacts its energy is
// constant, so it comes back as fast as it left: each impulse is e times the one before. The first speed follows from
// the fall: w^2 = 2 m g h / I about the hinge, at the lower cap I w / l = impulse / (1 + e).
TEST(PinnedBody, PendulumAtAWallBouncesWithItsRestitution) {
  constexpr double kRestitution = 0.7, kMass = 2, kInertia = kMass / 12 + kMass / 4;
  for (const double gap : {0.0, 1e-9, 1e-6, 1e-3})
    for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
      const Quat open(Eigen::AngleAxisd(std::numbers::pi / 3, Vec3::UnitZ()));
      const Trajectory run = simulate(sceneWith(fmt::format(
          R"("duration": 3, "accuracy": {}, "output": {{"framesPerSecond": 200}}, {}, "bodies": [{{"name": "wall",
          "shape": {{"plane": {{"normal": [1, 0, 0]}}}}, "position": [{}, 0, 0], "motion": "static", "material": "m"}},
          {{"name": "p", "shape": {{"capsule": {{"radius": 0.05, "length": 1}}}}, "mass": 2, "centerOfMass": [0, 0, 0],
          "inertiaTensor": [[{}, 0, 0], [0, 0.02, 0], [0, 0, {}]], "position": {}, "orientation": {},
          "material": "m"}}], "hinges": [{{"bodyA": "p", "anchorA": [0, 0.5, 0], "anchorB": [0, 0, 0]}}])",
          accuracy, materialsText(kRestitution, 0), -0.05 - gap, kMass / 12, kMass / 12,
          vectorText(open * Vec3(0, -0.5, 0)), orientationText(open))));
      const std::vector<Event> impacts = eventsOf(run, EventKind::impact);
      ASSERT_EQ(impacts.size(), 4u) << gap << " " << accuracy;
      const double fall = 0.5 * (std::cos(std::asin(gap)) - std::cos(std::numbers::pi / 3));
      double impulse =
          (1 + kRestitution) * std::sqrt(2 * kMass * kGravity * fall * kInertia) / std::cos(std::asin(gap));
      for (const Event& impact : impacts) {
        EXPECT_NEAR(impact.impulse, impulse, 20 * accuracy * impulse) << gap << " " << accuracy;
        impulse *= kRestitution;
      }
      for (const Frame& frame : run.frames) {
        const BodyState& state = frame.states[0];
        const double foot = (state.position + state.orientation * Vec3(0, -0.5, 0)).x();
        EXPECT_GT(foot, -gap - accuracy) << frame.time;
      }
    }
}

const Quat kTilt(Eigen::AngleAxisd(0.23, Vec3(0.6, 0, 0.8)));

const std::string kSlopeOfAPlane = R"("shape": {"plane": {}})",
                  kSlopeOfABox = fmt::format(R"("shape": {{"box": {{"size": [2, 1, 2]}}}}, "position": {})",
                                             vectorText(kTilt*Vec3(0.3, -0.5, 0.2)));

/// A body that touches a tilted floor at the origin, on a ball joint there.
Trajectory pinnedOnSlope(const std::string& slope, const std::string& shape, const Vec3& touching,
                         const Quat& orientation, double accuracy, double restitution) {
  return simulate(sceneWith(fmt::format(
      R"("duration": 0.3, "accuracy": {}, "output": {{"framesPerSecond": 480}}, {}, "bodies": [{{"name": "floor",
      {}, "orientation": {}, "motion": "static", "material": "m"}}, {{"name": "b", "shape": {},
      "material": "m", "position": {}, "orientation": {}}}],
      "ballJoints": [{{"bodyA": "b", "anchorA": {}, "anchorB": [0, 0, 0]}}])",
      accuracy, materialsText(restitution, 0.5), slope, orientationText(kTilt), shape,
      vectorText(-(orientation * touching)), orientationText(orientation), vectorText(touching))));
}

// A round end cannot roll about a point of its surface without sinking in: it turns about the floor's normal n alone.
// Its energy is that of a pendulum with the inertia n.I n about the anchor.
TEST(PinnedBody, RoundEndTurnsAboutTheFloorsNormalAlone) {
  const Quat orientation = Quat(Eigen::AngleAxisd(0.3, Vec3(0.8, 0, 0.6))) * kTilt;
  const Vec3 normal = kTilt * Vec3::UnitY(), inBody = orientation.conjugate() * normal;
  const Vec3 touching = Vec3(0, -0.1, 0) - 0.02 * inBody;
  for (const std::string& slope : {kSlopeOfAPlane, kSlopeOfABox})
    for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
      const double restitution = accuracy > 1e-7 ? 1 : 0;
      const Trajectory run = pinnedOnSlope(slope, R"({"capsule": {"radius": 0.02, "length": 0.2}})", touching,
                                           orientation, accuracy, restitution);
      EXPECT_GT(endOf(run).angularVelocity.norm(), 1);
      for (const Frame& frame : run.frames) {
        const BodyState& state = frame.states[0];
        EXPECT_LT((state.orientation * inBody - normal).norm(), 1e-9) << frame.time;
        EXPECT_LT((state.position + state.orientation * touching).norm(), 1e-9) << frame.time;
        EXPECT_NEAR(mechanicalEnergy(frame), mechanicalEnergy(run.frames[0]), accuracy) << frame.time;
      }
      EXPECT_TRUE(eventsOf(run, EventKind::impact).empty());
    }
}

TEST(PinnedBody, BallStaysOnThePlaceWhereItsSurfaceIsPinned) {
  for (const std::string& slope : {kSlopeOfAPlane, kSlopeOfABox}) {
    const Trajectory run =
        pinnedOnSlope(slope, R"({"sphere": {"radius": 0.1}})", kTilt * Vec3(0, -0.1, 0), Quat::Identity(), 1e-6, 0.5);
    for (const Frame& frame : run.frames) {
      EXPECT_LT((frame.states[0].position - run.frames[0].states[0].position).norm(), 1e-12) << slope;
      EXPECT_LT(frame.energy.kinetic, 1e-20) << slope;
    }
  }
}

// A rim at a pinned point of it can tip about its tangent t there, and turn about the floor's normal n; then t stays
// across n. Until the base lands, energy is kept.
TEST(PinnedBody, CylinderOnAPinnedPointOfItsRimTipsAboutItsTangent) {
  const Quat orientation = Quat(Eigen::AngleAxisd(0.4, Vec3(0, 0.6, 0.8))) * kTilt;
  const Vec3 normal = kTilt * Vec3::UnitY(), inBody = orientation.conjugate() * normal;
  const Vec3 outward = -Vec3(inBody.x(), 0, inBody.z()).normalized(), touching = 0.1 * outward + Vec3(0, -0.05, 0);
  const Vec3 tangent = outward.cross(Vec3::UnitY());
  for (const auto& [slope, accuracy] : std::vector<std::pair<std::string, double>>{{kSlopeOfAPlane, 1e-4},
                                                                                   {kSlopeOfAPlane, 1e-8},
                                                                                   {kSlopeOfABox, 1e-4},
                                                                                   {kSlopeOfABox, 1e-6},
                                                                                   {kSlopeOfABox, 1e-8}}) {
    const Trajectory run =
        pinnedOnSlope(slope, R"({"cylinder": {"radius": 0.1, "length": 0.1}})", touching, orientation, accuracy, 1);
    EXPECT_GT(endOf(run).angularVelocity.norm(), 0.5);
    for (const Frame& frame : run.frames) {
      const BodyState& state = frame.states[0];
      EXPECT_LT(std::abs((state.orientation * tangent).dot(normal)), 1e-9) << frame.time;
      for (int i = 0; i < 36; ++i) {
        const double angle = i * std::numbers::pi / 18;
        const Vec3 rim(0.1 * std::cos(angle), -0.05, 0.1 * std::sin(angle));
        EXPECT_GT(normal.dot(state.position + state.orientation * rim), -accuracy) << frame.time;
      }
      EXPECT_NEAR(energyConstantOf(frame), energyConstantOf(run.frames[0]), accuracy);
    }
    for (std::size_t i = 1; i < run.frames.size(); ++i)
      EXPECT_GE(run.frames[i].energy.dissipated, run.frames[i - 1].energy.dissipated - accuracy) << i;
  }
}

// A long flap whose hinge is a thousandth of its length inside its edge is an ordinary one: what it does is promised at
// every size, and it lies shut when the lower of its corners at the far end has come down.
TEST(PinnedBody, FlapHingedALittleInsideItsEdgeIsPromised) {
  for (const double size : {1.0, 100.0, 0.01})
    for (const double accuracy : {1e-3, 1e-6, 1e-8}) {
      const Vec3 half = size * Vec3(2.5, 0.01, 0.25), hinge(-half.x() + 0.005 * size, -half.y(), 0);
      const Quat open(Eigen::AngleAxisd(40 * std::numbers::pi / 180, Vec3::UnitZ()));
      const double height = (open * (hinge - Vec3(-half.x(), -half.y(), 0))).y();  // m: of the hinge, the edge touches
      std::vector<std::string> warnings;
      std::vector<Frame> frames;
      simulate(sceneWith(fmt::format(R"("duration": {}, "accuracy": {}, {}, "bodies": [{}, {{"name": "flap", "shape":
               {{"box": {{"size": {}}}}}, "material": "m", "position": {}, "orientation": {}}}], "hinges": [{{"bodyA":
               "flap", "anchorA": {}, "anchorB": [0, {}, 0]}}])",
                                     3 * std::sqrt(size), accuracy, materialsText(0, 0.5), kPlane, vectorText(2 * half),
                                     vectorText(Vec3(0, height, 0) - open * hinge), orientationText(open),
                                     vectorText(hinge), height)),
               {[&](const Frame& frame) { frames.push_back(frame); }, [](const Event&) {},
                [&](const std::string& text) { warnings.push_back(text); }});
      EXPECT_THAT(warnings, testing::IsEmpty()) << size << " " << accuracy;
      const BodyState& end = frames.back().states[0];
      const double farCorner = (end.position + end.orientation * Vec3(half.x(), -half.y(), 0)).y();
      EXPECT_LT(std::abs(farCorner), accuracy * (1 + end.position.norm())) << size << " " << accuracy;
      EXPECT_EQ(end.linearVelocity.norm(), 0) << size << " " << accuracy;
    }
}

// A ball pinned a hair above the place of its surface that comes to touch: it rattles within an angle of sqrt(2 gap /
// R), where forces have levers of as much of R. Contact steps let it sink in by 1e-6 R more, for a lever that they can
// follow. Nothing moves that is seen, and no energy comes of it.
TEST(PinnedBody, BallPinnedAHairOffThePlaneIsNotPromised) {
  constexpr double kRadius = 0.1, kMass = 1, kLoosened = 1e-6;
  for (const double gap : {3e-9, 1e-8, 3e-8})
    for (const double accuracy : {1e-3, 1e-6, 1e-9}) {
      const Quat turn(Eigen::AngleAxisd(0.4, Vec3(0.6, 0.8, 0)));
      std::vector<std::string> warnings;
      std::vector<Frame> frames;
      simulate(sceneWith(fmt::format(R"("duration": 0.1, "accuracy": {}, {}, "bodies": [{}, {{"name": "b", "mass": {},
               "shape": {{"sphere": {{"radius": {}}}}}, "material": "m", "position": [0, {}, 0], "orientation": {},
               "angularVelocity": [1, 0, 0.5]}}], "ballJoints": [{{"bodyA": "b", "anchorA": {}, "anchorB": [0, {}, 0]}}])",
                                     accuracy, materialsText(0.8, 0), kPlane, kMass, kRadius, kRadius + gap * kRadius,
                                     orientationText(turn), vectorText(turn.conjugate() * Vec3(0, -kRadius, 0)),
                                     gap * kRadius)),
               {[&](const Frame& frame) { frames.push_back(frame); }, [](const Event&) {},
                [&](const std::string& text) { warnings.push_back(text); }});
      EXPECT_THAT(warnings,
                  testing::Contains(testing::HasSubstr("within a thousandth of its size of a joint (ground, b)")))
          << gap << " " << accuracy;
      const double start = mechanicalEnergy(frames[0]);
      for (const Frame& frame : frames) {
        EXPECT_LT(mechanicalEnergy(frame) - start, 1e-9 * kMass * kGravity * kRadius) << gap << " " << accuracy;
        EXPECT_LT((frame.states[0].position - frames[0].states[0].position).norm(),
                  2 * std::sqrt(2 * (gap + kLoosened)) * kRadius);
      }
    }
}

/// A body of which a round side, or a face, touches something at the origin that has there the normal kTouchedNormal.
struct TouchingBody {
  const char* shape;
  Vec3 touching;  // m, body's frame
  Quat orientation;
};

const Vec3 kTouchedNormal(0, std::cos(0.6), std::sin(0.6));

std::vector<TouchingBody> bodiesThatTouch() {
  const Vec3 across(std::cos(0.9), -std::sin(0.9) * kTouchedNormal.z(), std::sin(0.9) * kTouchedNormal.y());
  Mat3 lying;  // the axis y of the body across the normal, and askew to the edge
  lying << -kTouchedNormal, across, -kTouchedNormal.cross(across);
  const Quat askew(lying), turn(Eigen::AngleAxisd(0.7, Vec3(0.6, 0, 0.8)));
  return {{R"({"sphere": {"radius": 0.1}})", turn.conjugate() * Vec3(-0.1 * kTouchedNormal), turn},
          {R"({"cylinder": {"radius": 0.1, "length": 0.3}})", {0.1, 0.03, 0}, askew},
          {R"({"capsule": {"radius": 0.1, "length": 0.3}})", {0.1, 0.03, 0}, askew},
          {R"({"box": {"size": [0.2, 0.3, 0.1]}})", {0.1, 0.03, 0.01}, askew}};
}

// What is round at a joint's anchor cannot roll along an edge there, nor on what is round itself; about an edge it can,
// until its end lands (at 0.2 s a ball would have come to lie on the face beside). Nothing sinks in, and energy is
// kept.
TEST(PinnedBody, RollsNeitherAlongAnEdgeNorOnWhatIsRound) {
  const std::string edge = R"("shape": {"box": {"size": [2, 1, 1]}}, "position": [0.1, -0.5, -0.5])";
  const std::string ball =
      fmt::format(R"("shape": {{"sphere": {{"radius": 0.3}}}}, "position": {})", vectorText(-0.3 * kTouchedNormal));
  const std::string pole = fmt::format(R"("shape": {{"capsule": {{"radius": 0.3, "length": 3}}}}, "position": {},
      "orientation": {{"axis": [0, 0, 1], "angleDegrees": 90}})",
                                       vectorText(-0.3 * kTouchedNormal));
  for (const std::string& ground : {edge, ball, pole})
    for (const TouchingBody& body : bodiesThatTouch())
      for (const double accuracy : {1e-4, 1e-8}) {
        const Scene scene = sceneWith(fmt::format(
            R"("duration": 0.2, "accuracy": {}, {}, "bodies": [{{"name": "ground", {}, "motion": "static",
            "material": "m"}}, {{"name": "b", "shape": {}, "material": "m", "position": {}, "orientation": {}}}],
            "ballJoints": [{{"bodyA": "b", "anchorA": {}, "anchorB": [0, 0, 0]}}])",
            accuracy, materialsText(0.5, 0.3), ground, body.shape, vectorText(-(body.orientation * body.touching)),
            orientationText(body.orientation), vectorText(body.touching)));
        const Trajectory run = simulate(scene);
        const Assembly assembly = assemble(scene, touchingScene(scene));
        DriftMeter meter(assembly);
        for (const Frame& frame : run.frames) {
          meter.add(frame);
          EXPECT_NEAR(energyConstantOf(frame), energyConstantOf(run.frames[0]), accuracy) << ground << body.shape;
        }
        EXPECT_LT(meter.penetration(), 1e-10) << ground << body.shape << accuracy;
      }
}

// A lid hinged to the edge of a box that moves freely, with "collide": it lands on the box, which rests on the floor.
TEST(PinnedBody, LidLandsOnTheBoxThatItIsHingedTo) {
  for (const double accuracy : {1e-3, 1e-4, 1e-6}) {
    const Quat open(Eigen::AngleAxisd(std::numbers::pi / 3, Vec3::UnitZ()));
    const Vec3 edge(-0.25, -0.01, 0);
    const Trajectory run = simulate(sceneWith(fmt::format(
        R"("duration": 2, "accuracy": {}, "output": {{"framesPerSecond": 100}}, {}, "bodies": [{}, {{"name": "box",
        "shape": {{"box": {{"size": [0.5, 0.3, 0.4]}}}}, "material": "m", "position": [0.25, 0.15, 0]}}, {{"name": "lid",
        "shape": {{"box": {{"size": [0.5, 0.02, 0.4]}}}}, "material": "m", "position": {}, "orientation": {}}}],
        "hinges": [{{"bodyA": "lid", "anchorA": {}, "bodyB": "box", "anchorB": [-0.25, 0.15, 0], "collide": true}}])",
        accuracy, materialsText(0, 0.5), kPlane, vectorText(Vec3(0, 0.3, 0) - open * edge), orientationText(open),
        vectorText(edge))));
    const BodyState box = run.frames.back().states[0], lid = run.frames.back().states[1];
    const Vec3 onBox = box.orientation.conjugate() * (lid.position - box.position);
    EXPECT_LT((onBox - Vec3(0, 0.16, 0)).norm(), 1e-3) << accuracy;
    EXPECT_LT(lid.linearVelocity.norm(), 1e-6) << accuracy;
    EXPECT_LT(lid.angularVelocity.norm(), 1e-6) << accuracy;
  }
}

// A ladder without friction slides down a wall: while both ends touch, frames inside of steps keep them, as the rows of
// the contacts do at the steps' ends.
// A lid of length l with its hinge on the middle of its end, over the edge of a box: it lies shut flat on the box. Its
// lower edge beside the hinge comes down with it, and is nearer to the box than the accuracy long before the far one
// strikes: that edge does not stop the lid. Opened by 60 degrees, its centre of mass falls by h = l sin(60) / 2, and
// the bounce leaves e^2 m g h: its energy is that to the error of the speed at the impact, some accuracies of itself.
TEST(PinnedBody, LidBouncesOffTheBoxWithItsRestitutionAtEveryAccuracy) {
  constexpr double kMass = 1, kHeight = 0.4330127018922193;  // kg, m
  for (const double accuracy : {1e-2, 1e-3, 1e-4, 1e-6})
    for (const double thickness : {0.02, 0.1})
      for (const double restitution : {0.3, 0.8, 1.0}) {
        const Quat open(Eigen::AngleAxisd(std::numbers::pi / 3, Vec3::UnitZ()));
        const Vec3 hinge(0, thickness / 2, 0), place = hinge + open * Vec3(0.5, 0, 0);
        const Trajectory run = simulate(sceneWith(fmt::format(
            R"("duration": 0.6, "accuracy": {}, "output": {{"framesPerSecond": 100}}, {}, "bodies": [{}, {{"name": "lid",
            "shape": {{"box": {{"size": [1, {}, 0.5]}}}}, "material": "m", "mass": {}, "position": {}, "orientation": {}}}],
            "hinges": [{{"bodyA": "lid", "anchorA": [-0.5, 0, 0], "bodyB": "ground", "anchorB": [-0.5, {}, 0],
            "collide": true}}])",
            accuracy, materialsText(restitution, 0.5), kBlockUnderFlap, thickness, kMass, vectorText(place),
            orientationText(open), 0.5 + thickness / 2)));
        const std::vector<Event> impacts = eventsOf(run, EventKind::impact);
        ASSERT_FALSE(impacts.empty());
        const double fallen = kMass * kGravity * kHeight, shut = mechanicalEnergy(run.frames[0]) - fallen;
        const auto after = std::find_if(run.frames.begin(), run.frames.end(),
                                        [&](const Frame& frame) { return frame.time > impacts[0].time + 0.01; });
        ASSERT_NE(after, run.frames.end());
        EXPECT_NEAR((mechanicalEnergy(*after) - shut) / fallen, restitution * restitution, 10 * accuracy)
            << "accuracy " << accuracy << ", thickness " << thickness;
        EXPECT_LT(impacts[0].impulse, 10 * kMass) << "of the edge beside the hinge";
      }
}

TEST(SlidingLadder, TouchesWallAndFloorInEveryFrame) {
  const Quat lean(Eigen::AngleAxisd(0.4, Vec3::UnitZ()));
  for (const double accuracy : {1e-3, 1e-4, 1e-6}) {
    const Trajectory run = simulate(sceneWith(fmt::format(
        R"("duration": 0.3, "accuracy": {}, "output": {{"framesPerSecond": 480}}, {}, "bodies": [{}, {{"name": "wall",
        "shape": {{"plane": {{"normal": [1, 0, 0]}}}}, "motion": "static", "material": "m"}}, {{"name": "ladder",
        "shape": {{"capsule": {{"radius": 0.02, "length": 1}}}}, "material": "m", "position": {}, "orientation": {}}}])",
        accuracy, materialsText(0, 0), kPlane,
        vectorText(Vec3(0.02 + 0.5 * std::sin(0.4), 0.02 + 0.5 * std::cos(0.4), 0)), orientationText(lean))));
    ASSERT_TRUE(eventsOf(run, EventKind::release).empty());
    for (const Frame& frame : run.frames) {
      const BodyState& state = frame.states[0];
      const Vec3 up = state.position + state.orientation * Vec3(0, 0.5, 0);
      const Vec3 down = state.position + state.orientation * Vec3(0, -0.5, 0);
      EXPECT_NEAR(std::min(up.x(), down.x()), 0.02, 1e-9) << accuracy << " " << frame.time;
      EXPECT_NEAR(std::min(up.y(), down.y()), 0.02, 1e-9) << accuracy << " " << frame.time;
    }
  }
}

// A box that turns about a point of its lower edge on a tilted block. Where its far corners and edges come down there
// is no contact beside the joint before, and no gap to one that shrinks. The point may be `gap` (m) above the block.
Scene boxOnTiltedBlock(double accuracy, const Vec3& velocity, double gap) {
  const Quat block(0.9975501482244304, 0.05135387052655701, 0, -0.047502439509549355);
  const Vec3 up = gap * (block * Vec3::UnitY());
  return sceneWith(fmt::format(R"("duration": 0.3, "accuracy": {}, "output": {{"framesPerSecond": 200}}, {}, "bodies": [
    {{"name": "block", "shape": {{"box": {{"size": [0.3, 0.1, 0.2]}}}}, "motion": "static", "material": "m",
      "orientation": {}}},
    {{"name": "box", "mass": 20, "material": "m",
      "shape": {{"box": {{"size": [0.08014099875500935, 0.1973331900052787, 0.255255765781206]}}}},
      "position": {}, "linearVelocity": {},
      "orientation": {{"w": 0.9492816770537533, "x": 0, "y": 0.31442693524889626, "z": 0}}}}],
    "ballJoints": [{{"bodyA": "box", "anchorA": [-0.040070499377514474, -0.09866659500272192, -0.02335698858364489],
                    "anchorB": {}}}])",
                               accuracy, materialsText(1, 0.5), orientationText(block),
                               vectorText(up + Vec3(-0.017658609625094454, 0.16498944544293126, -0.09919352045416473)),
                               vectorText(velocity),
                               vectorText(up + Vec3(-0.06374920066848871, 0.06632285044020934, -0.09401170095417342))));
}

TEST(BoxPinnedByItsEdge, MeetsTheBlockWithAllThatComesDown) {
  for (const Vec3& velocity : {Vec3(-0.88, 0, -0.51), Vec3(0.6, 0, -0.4), Vec3(0.2, 0, 0.9), Vec3(0, 0, 0)})
    for (const double gap : {0.0, 1e-11, 1e-10, 1e-9, 1e-8})
      for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-8}) {
        const RandomSceneFigures figures = runRandomScene(boxOnTiltedBlock(accuracy, velocity, gap));
        SCOPED_TRACE(::testing::Message() << accuracy << ", velocity " << velocity.transpose() << ", gap " << gap);
        EXPECT_LT(figures.penetration, 1e-9 + 0.01 * accuracy);
        EXPECT_LT(figures.constraintError, 1e-9);
      }
}

/// The lowest point (m, its frame) of a box, a capsule or a cylinder, each 1 m long, where `down` (unit) is down.
Vec3 lowestPoint(std::size_t shape, const Vec3& down) {
  const double end = std::copysign(0.5, down.y());
  if (shape == 0) return {std::copysign(0.3, down.x()), end, std::copysign(0.25, down.z())};
  if (shape == 1) return Vec3(0, end, 0) + 0.3 * down;
  return Vec3(0, end, 0) + 0.3 * Vec3(down.x(), 0, down.z()).normalized();
}

// A body on a ball joint at, or a hair above, the floor, whose other end comes down and bounces until it rests. Each of
// the bounces ends as deep as it began: with the depth of one that counts as an impact, 5e-10 of the size, each of them
// would sink in by so much, and gain the height for the next ones: thousands, and a place that is none of the scene's.
TEST(PinnedBody, BouncesToRestWithoutSinkingIn) {
  const std::array<const char*, 3> shapes = {R"({"box": {"size": [0.6, 1, 0.5]}})",
                                             R"({"capsule": {"radius": 0.3, "length": 1}})",
                                             R"({"cylinder": {"radius": 0.3, "length": 1}})"};
  int kept = 0;
  for (const std::string& ground : {kPlane, kBox})
    for (std::size_t shape = 0; shape < shapes.size(); ++shape)
      for (int i = 0; i < 12; ++i)
        for (const double accuracy : {1e-6, 1e-8, 1e-10}) {
          const double gap = std::array{0.0, 1e-6, 1e-3}[static_cast<std::size_t>(i) % 3],
                       restitution = i % 2 ? 0.8 : 0.6;
          SCOPED_TRACE(testing::Message() << ground << shapes[shape] << i << " " << accuracy);
          const Quat turn(Eigen::AngleAxisd(0.3 + 0.2 * i, Vec3(std::cos(i), 0, std::sin(i))));
          const Vec3 anchor = lowestPoint(shape, turn.conjugate() * Vec3(0, -1, 0)), place(0.2, gap, -0.1);
          const Scene scene = sceneWith(fmt::format(
              R"("duration": 2.5, "accuracy": {}, {}, "bodies": [{}, {{"name": "b", "mass": 1, "shape": {},
              "material": "m", "position": {}, "orientation": {}}}],
              "ballJoints": [{{"bodyA": "b", "anchorA": {}, "anchorB": {}}}])",
              accuracy, materialsText(restitution, 0.3), ground, shapes[shape], vectorText(place - turn * anchor),
              orientationText(turn), vectorText(anchor), vectorText(place)));
          const RandomSceneFigures figures = runRandomScene(scene);
          if (!figures.keepsAccuracy) continue;  // a cylinder that lands flat rolls on its rim by the pin
          ++kept;
          EXPECT_LT(figures.penetration, 1e-9 + 0.01 * accuracy);
        }
  EXPECT_GE(kept, 200) << "of 216";
}

// A heavy capsule jams a light cylinder between the floor and its hinge, a thousandth of its size beside the contact:
// forces of 1e6 N on 0.02 kg, whose rounding alone asks for steps of 3e-7 s. They are not taken for long: 7 million
// evaluations would be.
TEST(PinnedBody, JammedAtItsHingeIsNotFollowedInStepsOfRounding) {
  const Trajectory run = simulate(sceneWith(R"("duration": 0.3, "accuracy": 1e-8, "output": {"framesPerSecond": 240},
    "materials": {"m": {"restitution": 0.3, "staticFriction": 0, "dynamicFriction": 0}},
    "bodies": [{"name": "ground", "shape": {"plane": {}}, "material": "m", "motion": "static"},
    {"name": "light", "shape": {"cylinder": {"radius": 0.12360630772610004, "length": 0.08210194077402366}},
      "material": "m", "mass": 0.017062650047452076,
      "position": [-0.02653520506022044, 0.07732388540541946, -0.01223888603485607],
      "orientation": {"w": -0.9669283160100205, "x": -0.14483693845859638, "y": -0.20112609633033454,
        "z": -0.060167984268111464}},
    {"name": "heavy", "shape": {"capsule": {"radius": 0.10853073012792024, "length": 0.08319266009686138}},
      "material": "m", "mass": 17.495187760007507,
      "position": [-0.02653520506022044, 0.24819374451523313, -0.01223888603485607],
      "orientation": {"w": 0.07554205595974116, "x": 0.07554205595974114, "y": 0.7030600243090027,
        "z": -0.7030600243090026}}],
    "hinges": [{"bodyA": "light", "anchorA": [-0.06967175214045666, -0.04105103230564826, 0.10209981023847897],
      "anchorB": [-0.04618982419897438, 6.512238765604694e-08, 0.09070981144967721],
      "axis": [-0.10971078559270939, -0.2394778657090345, -0.9646833135076383]},
    {"bodyA": "heavy", "anchorA": [0.0008548229938869119, 0.07520748101813518, 0.10319146859232259],
      "anchorB": [-0.011393257839913665, 0.14500227592291057, -0.08591125098821893],
      "axis": [0.9673834231147925, -0.2431128059920186, 0.07117215920143495]}])"));
  EXPECT_LT(run.cost.evaluations, 500000);
}

}  // namespace
}  // namespace cradle
