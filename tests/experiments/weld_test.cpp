#include <gtest/gtest.h>

#include "experiments/tie_error.h"

// Welded bodies, and the one body that they are. No body has a symmetry that the experiment does not need.

namespace cradle {
namespace {

constexpr double kRestitution = 0.6;
const std::string kSmooth = fmt::format(
    R"("materials": {{"smooth": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}}, )", kRestitution);

/// A part of a whole: a sphere about its centre of mass.
struct WeldedPart {
  double mass, radius;
  Vec3 position;
  Quat orientation;
  Mat3 inertiaTensor;  // about the centre of mass, in the part's frame
};

const std::array<WeldedPart, 2> kParts{
    {{2, 0.1, Vec3(0.1, 0, -0.05), Quat(Eigen::AngleAxisd(0.5, Vec3(1, 2, 2) / 3)),
      (Mat3() << 0.08, 0.01, -0.02, 0.01, 0.05, 0.005, -0.02, 0.005, 0.07).finished()},
     {0.7, 0.15, Vec3(-0.3, 0.5, 0.2), Quat(Eigen::AngleAxisd(-1.1, Vec3(2, -1, 2) / 3)),
      (Mat3() << 0.02, 0.003, 0, 0.003, 0.03, -0.004, 0, -0.004, 0.025).finished()}}};

/// Mass, centre of mass and inertia tensor about it of both, in the world's frame at the start.
MassProperties wholeOf(const std::array<WeldedPart, 2>& parts) {
  MassProperties whole;
  for (const WeldedPart& part : parts) {
    whole.mass += part.mass;
    whole.centerOfMass += part.mass * part.position;
  }
  whole.centerOfMass /= whole.mass;
  whole.inertiaTensor.setZero();
  for (const WeldedPart& part : parts) {
    const Vec3 away = part.position - whole.centerOfMass;
    const Mat3 turn = part.orientation.toRotationMatrix();
    whole.inertiaTensor += turn * part.inertiaTensor * turn.transpose() +
                           part.mass * (away.squaredNorm() * Mat3::Identity() - away * away.transpose());
  }
  return whole;
}

std::string partText(const char* name, const WeldedPart& part, const Vec3& velocity, const Vec3& spin) {
  const Quat& q = part.orientation;
  const Mat3& inertia = part.inertiaTensor;
  return fmt::format(
      R"({{"name": "{}", "shape": {{"sphere": {{"radius": {}}}}}, "mass": {}, "material": "smooth", "centerOfMass": [0, 0, 0],
      "inertiaTensor": [{}, {}, {}], "position": {}, "orientation": {{"w": {}, "x": {}, "y": {}, "z": {}}},
      "linearVelocity": {}, "angularVelocity": {}}})",
      name, part.radius, part.mass, vectorText(inertia.row(0)), vectorText(inertia.row(1)), vectorText(inertia.row(2)),
      vectorText(part.position), q.w(), q.x(), q.y(), q.z(), vectorText(velocity), vectorText(spin));
}

/// Both parts, moving as the whole does with the velocity of its centre of mass and its spin, welded at a point of the
/// world that lies in neither.
std::string weldedText(const Vec3& velocity, const Vec3& spin) {
  const Vec3 center = wholeOf(kParts).centerOfMass, seam(0.2, 0.3, 0.1);
  std::vector<std::string> bodies;
  for (const WeldedPart& part : kParts)
    bodies.push_back(partText(bodies.empty() ? "a" : "b", part, velocity + spin.cross(part.position - center), spin));
  const auto seen = [&](const WeldedPart& part) {
    return vectorText(part.orientation.conjugate() * (seam - part.position));
  };
  return fmt::format(R"("bodies": [{}, {}], "welds": [{{"bodyA": "a", "anchorA": {}, "bodyB": "b", "anchorB": {}}}])",
                     bodies[0], bodies[1], seen(kParts[0]), seen(kParts[1]));
}

// Euler's rigid body in closed form moves the whole; the parts go with it. Errors of 1e-10 in the spin grow with the
// angle, of some 30 rad.
TEST(WeldedPair, TumblesAsTheOneBodyThatItIs) {
  const Vec3 velocity(0.5, 3, -1), spin(4, -3, 5);
  const std::string settings = kSmooth + R"("duration": 4, "accuracy": 1e-10, "output": {"framesPerSecond": 5}, )";
  const Scene scene = sceneWith(settings + weldedText(velocity, spin));
  const Trajectory run = simulate(scene);
  const MassProperties merged = wholeOf(kParts);
  const WeldedPart body{merged.mass, 0.1, merged.centerOfMass, Quat::Identity(), merged.inertiaTensor};
  const Trajectory one = simulate(sceneWith(settings + R"("bodies": [)" + partText("ab", body, velocity, spin) + "]"));
  ASSERT_EQ(run.frames.size(), one.frames.size());
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const BodyState& whole = one.frames[i].states[0];
    for (std::size_t part = 0; part < 2; ++part) {
      const BodyState& state = run.frames[i].states[part];
      const Vec3 away = whole.orientation * (kParts[part].position - merged.centerOfMass);
      EXPECT_LT((state.position - whole.position - away).norm(), 1e-8) << i << part;
      EXPECT_LT(orientationError(state.orientation, whole.orientation * kParts[part].orientation), 1e-8) << i << part;
      EXPECT_LT((state.angularVelocity - whole.angularVelocity).norm(), 1e-7) << i << part;
    }
    EXPECT_NEAR(ledgerConstantOf(run.frames[i]), ledgerConstantOf(run.frames[0]), 1e-11) << i;
  }
  EXPECT_LT(largestTieError(run, scene), 1e-11);
}

// A strikes a plane without friction, while nothing pulls: the impulse is j = -(1 + e) v / (n . K n) with v the speed
// of the point of contact along the normal n and K n = n / M + I^-1 (r x n) x r, of the whole.
TEST(WeldedPair, StrikesAFloorAsTheOneBodyThatItIs) {
  const Vec3 velocity(0.5, -2, 0.3), spin(0.4, 0.3, -0.6), normal = Vec3::UnitY();
  const MassProperties whole = wholeOf(kParts);
  // The floor just below A's sphere: what turns until then is rounding of its place, 1e-9.
  const double height = kParts[0].position.y() - kParts[0].radius;
  std::string text = weldedText(velocity, spin);
  const std::size_t bodies = text.find('[') + 1;
  text.insert(
      bodies,
      fmt::format(
          R"({{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "smooth", "position": [0, {}, 0]}}, )",
          height - 1e-9));
  const Trajectory run = simulate(sceneWith(
      kSmooth + R"("duration": 0.01, "accuracy": 1e-10, "gravity": [0, 0, 0], "output": {"framesPerSecond": 100}, )" +
      text));
  ASSERT_EQ(eventsOf(run, EventKind::impact).size(), 1u);
  const Vec3 point = kParts[0].position - kParts[0].radius * normal, arm = point - whole.centerOfMass;
  const double closing = normal.dot(velocity + spin.cross(arm));
  const Vec3 turn = whole.inertiaTensor.inverse() * arm.cross(normal);
  const double impulse = -(1 + kRestitution) * closing / (1 / whole.mass + normal.dot(turn.cross(arm)));
  const EnergyBalance &before = run.frames.front().energy, &after = run.frames.back().energy;
  EXPECT_NEAR(eventsOf(run, EventKind::impact)[0].impulse, impulse, 1e-7);
  EXPECT_LT((after.momentum - before.momentum - impulse * normal).norm(), 1e-7);
  EXPECT_LT((after.angularMomentum - before.angularMomentum - impulse * point.cross(normal)).norm(), 1e-7);
  EXPECT_NEAR(after.dissipated, -impulse * closing * (1 - kRestitution) / 2, 1e-7);
  EXPECT_NEAR(after.kinetic, before.kinetic - after.dissipated, 1e-9);
}

// Ten parts on from a wall, each a thousand times as heavy or as light as the one before: nothing moves.
TEST(WeldedBeam, StaysWhereItIs) {
  std::string bodies, welds;
  for (int i = 0; i < 10; ++i) {
    bodies += fmt::format(
        R"({}{{"name": "{}", "shape": {{"box": {{"size": [1, 0.2, 0.2]}}}}, "mass": {}, "position": [{}, 0, 0]}})",
        i == 0 ? "" : ", ", i, i % 2 == 0 ? 0.001 : 1, i + 0.5);
    welds += fmt::format(R"({}{{"bodyA": "{}", "anchorA": [-0.5, 0, 0], "anchorB": [{}, 0, 0]{}}})", i == 0 ? "" : ", ",
                         i, i == 0 ? 0 : 0.5, i == 0 ? "" : fmt::format(R"(, "bodyB": "{}")", i - 1));
  }
  const Scene scene = sceneWith(R"("duration": 1, "output": {"framesPerSecond": 10}, "bodies": [)" + bodies +
                                R"(], "welds": [)" + welds + "]");
  const Trajectory run = simulate(scene);
  for (const Frame& frame : run.frames)
    for (std::size_t i = 0; i < 10; ++i)
      EXPECT_LT((frame.states[i].position - Vec3(static_cast<double>(i) + 0.5, 0, 0)).norm(), 1e-12) << frame.time << i;
}

// Parts of one body may overlap, and touch each other however it turns: that is no contact, nor near to one, though
// each of them may touch a floor.
TEST(WeldedParts, OverlapWithoutContact) {
  for (const double accuracy : {1e-3, 1e-6}) {
    const Trajectory run = simulate(sceneWith(fmt::format(R"("duration": 1, "accuracy": {}, "gravity": [0, 0, 0],
      "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "position": [0, -9, 0]}},
        {{"name": "a", "shape": {{"box": {{"size": [0.2, 0.2, 0.2]}}}}, "angularVelocity": [3, 1, -2]}},
        {{"name": "b", "shape": {{"cylinder": {{"radius": 0.1, "length": 0.2}}}}, "position": [0.2, 0, 0], "angularVelocity": [3, 1, -2], "linearVelocity": [0, -0.4, -0.2]}},
        {{"name": "c", "shape": {{"box": {{"size": [0.2, 0.2, 0.2]}}}}, "position": [0.1, 0.15, 0], "angularVelocity": [3, 1, -2], "linearVelocity": [0.3, -0.2, 0.35]}}],
      "welds": [{{"bodyA": "a", "anchorA": [0.1, 0, 0], "bodyB": "b", "anchorB": [-0.1, 0, 0], "collide": true}},
                {{"bodyA": "a", "anchorA": [0.05, 0.1, 0], "bodyB": "c", "anchorB": [-0.05, -0.05, 0]}}])",
                                                          accuracy)));
    EXPECT_TRUE(run.events.empty());
    EXPECT_LT(largestEnergyError(run), 10 * accuracy);
    EXPECT_GT(run.frames[0].energy.kinetic, 0.1);
  }
}

}  // namespace
}  // namespace cradle
