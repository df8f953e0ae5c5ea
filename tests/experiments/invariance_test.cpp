// The same scene seen in a mirror, from another side, with its parts in another order: contact with friction, rods,
// ropes, springs and joints at once. What happens must not depend on that.

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/random_poses.h"
#include "experiments/experiment.h"
#include "math/rotation.h"

namespace cradle {
namespace {

struct Thing {
  std::string name, shape;  // symmetric to z = 0
  Vec3 position;
  Quat turn;
  Vec3 velocity, spin;
};

struct Link {
  std::string kind, more;
  std::string a, b;  // b empty: the world
  Vec3 anchorA, anchorB;
};

/// A scene, as what stands in it.
struct Yard {
  Vec3 gravity = Vec3(0, -9.81, 0), floorNormal = Vec3(0.1, 1, -0.15).normalized();
  std::vector<Thing> things;
  std::vector<Link> links;
};

/// Close over a floor that slopes: a dumbbell of a ball and a capsule, two boxes on a spring, a cylinder on a rope that
/// goes taut, a box on a ball joint.
Yard makeYard() {
  RandomPoses random(31);
  Yard yard;
  const auto add = [&](const std::string& name, const std::string& shape, const Vec3& position) {
    const Quat turn = random.turn();
    const Vec3 velocity = random.vector(1), spin = random.vector(3);
    yard.things.push_back({name, shape, position, turn, velocity, spin});
  };
  add("ball", R"({"sphere": {"radius": 0.1}})", Vec3(0, 0.3, 0));
  add("capsule", R"({"capsule": {"radius": 0.08, "length": 0.2}})", Vec3(0.5, 0.5, 0.1));
  add("crate", R"({"box": {"size": [0.2, 0.15, 0.3]}})", Vec3(-0.6, 0.4, 0.2));
  add("box", R"({"box": {"size": [0.1, 0.25, 0.15]}})", Vec3(-0.6, 0.8, 0.5));
  add("drum", R"({"cylinder": {"radius": 0.1, "length": 0.2}})", Vec3(0.2, 0.9, -0.6));
  add("door", R"({"box": {"size": [0.3, 0.2, 0.1]}})", Vec3(-0.3, 1.2, -0.8));
  const Thing& door = yard.things.back();
  const Vec3 jamb(0.2, 0.05, 0.02);
  yard.links = {
      {"rods", "", "ball", "capsule", Vec3(0, 0.02, 0.05), Vec3(0.03, 0.1, 0)},
      {"springs", R"(, "stiffness": 300, "damping": 2, "restLength": 0.4)", "crate", "box", Vec3(0.1, 0.07, 0.1),
       Vec3(0, -0.1, 0)},
      {"ropes", R"(, "maxLength": 0.45, "restitution": 0.4)", "drum", "", Vec3(0.05, 0.1, 0.02), Vec3(0.2, 1.3, -0.55)},
      {"ballJoints", "", "door", "", jamb, Vec3(door.position + door.turn * jamb)}};
  return yard;
}

/// In the mirror z = 0: spins are axial.
Yard mirrored(Yard yard) {
  const auto flip = [](const Vec3& v) { return Vec3(v.x(), v.y(), -v.z()); };
  yard.floorNormal = flip(yard.floorNormal);
  for (Thing& thing : yard.things) {
    thing.position = flip(thing.position), thing.velocity = flip(thing.velocity), thing.spin = -flip(thing.spin);
    thing.turn = Quat(thing.turn.w(), -thing.turn.x(), -thing.turn.y(), thing.turn.z());
  }
  for (Link& link : yard.links) link.anchorA = flip(link.anchorA), link.anchorB = flip(link.anchorB);
  return yard;
}

Yard turned(Yard yard, const Quat& turn) {
  yard.gravity = turn * yard.gravity, yard.floorNormal = turn * yard.floorNormal;
  for (Thing& thing : yard.things) {
    thing.position = turn * thing.position, thing.velocity = turn * thing.velocity, thing.spin = turn * thing.spin;
    thing.turn = turn * thing.turn;
  }
  for (Link& link : yard.links)
    if (link.b.empty()) link.anchorB = turn * link.anchorB;
  return yard;
}

/// Bodies and links in another order, links between bodies from the other side.
Yard renumbered(Yard yard) {
  std::reverse(yard.things.begin(), yard.things.end());
  std::rotate(yard.things.begin(), yard.things.begin() + 2, yard.things.end());
  std::reverse(yard.links.begin(), yard.links.end());
  for (Link& link : yard.links)
    if (!link.b.empty()) std::swap(link.a, link.b), std::swap(link.anchorA, link.anchorB);
  return yard;
}

std::string textOf(const Link& link) {
  const std::string other = link.b.empty() ? "" : fmt::format(R"("bodyB": "{}", )", link.b);
  return fmt::format(R"("{}": [{{"bodyA": "{}", {}"anchorA": {}, "anchorB": {}{}}}])", link.kind, link.a, other,
                     vectorText(link.anchorA), vectorText(link.anchorB), link.more);
}

std::string textOf(const Thing& thing) {
  const Quat& q = thing.turn;
  return fmt::format(R"({{"name": "{}", "shape": {}, "mass": 1.5, "material": "m", "position": {}, "orientation":
    {{"w": {}, "x": {}, "y": {}, "z": {}}}, "linearVelocity": {}, "angularVelocity": {}}})",
                     thing.name, thing.shape, vectorText(thing.position), q.w(), q.x(), q.y(), q.z(),
                     vectorText(thing.velocity), vectorText(thing.spin));
}

Trajectory runOf(const Yard& yard, double accuracy) {
  std::vector<std::string> bodies, links;
  for (const Thing& thing : yard.things) bodies.push_back(textOf(thing));
  for (const Link& link : yard.links) links.push_back(textOf(link));
  return simulate(sceneWith(fmt::format(
      R"("duration": 0.5, "accuracy": {}, "gravity": {}, "output": {{"framesPerSecond": 20}},
      "materials": {{"m": {{"restitution": 0.4, "staticFriction": 0.5, "dynamicFriction": 0.4}}}},
      "bodies": [{{"name": "floor", "shape": {{"plane": {{"normal": {}}}}}, "motion": "static", "material": "m"}}, {}], {})",
      accuracy, vectorText(yard.gravity), vectorText(yard.floorNormal), fmt::join(bodies, ", "),
      fmt::join(links, ", "))));
}

/// Largest distance of a body from where it is in the other run, seen from there.
template <class Map>
double difference(const Yard& yard, const Trajectory& run, const Yard& other, const Trajectory& otherRun,
                  const Map& toOther) {
  double largest = 0;
  for (std::size_t frame = 0; frame < run.frames.size(); ++frame)
    for (std::size_t i = 0; i < yard.things.size(); ++i) {
      const auto same = std::find_if(other.things.begin(), other.things.end(),
                                     [&](const Thing& thing) { return thing.name == yard.things[i].name; });
      const auto at = static_cast<std::size_t>(same - other.things.begin());
      const Vec3 here = toOther(run.frames[frame].states[i].position),
                 there = otherRun.frames[frame].states[at].position;
      largest = std::max(largest, (here - there).norm());
    }
  return largest;
}

class Invariance : public testing::TestWithParam<double> {
 protected:
  const Yard yard_ = makeYard();
  const Trajectory run_ = runOf(yard_, GetParam());
  // Errors of a step in either run; the impacts and the rope's pulls double them some times.
  const double tolerance_ = 100 * GetParam();
};

TEST_P(Invariance, OfAMirrorImage) {
  const Yard other = mirrored(yard_);
  EXPECT_LT(difference(yard_, run_, other, runOf(other, GetParam()),
                       [](const Vec3& v) { return Vec3(v.x(), v.y(), -v.z()); }),
            tolerance_);
}

TEST_P(Invariance, OfATurnedScene) {
  const Quat turn = rotationAbout(Vec3(1, -2, 0.5).normalized(), 1.1);
  const Yard other = turned(yard_, turn);
  EXPECT_LT(difference(yard_, run_, other, runOf(other, GetParam()), [&](const Vec3& v) { return Vec3(turn * v); }),
            tolerance_);
}

TEST_P(Invariance, OfAnotherOrder) {
  const Yard other = renumbered(yard_);
  EXPECT_LT(difference(yard_, run_, other, runOf(other, GetParam()), [](const Vec3& v) { return v; }), tolerance_);
}

// The scene is worth it: things strike the floor, slide on it, and the rope goes taut.
TEST_P(Invariance, IsAskedOfAScenesWithContactAndPulls) {
  for (const EventKind kind : {EventKind::impact, EventKind::taut})
    EXPECT_GT(
        std::count_if(run_.events.begin(), run_.events.end(), [&](const Event& event) { return event.kind == kind; }),
        0);
  EXPECT_GT(run_.frames.back().energy.dissipated, 0.1);
}

INSTANTIATE_TEST_SUITE_P(AtAccuracies, Invariance, testing::Values(1e-5, 1e-8),
                         [](const auto& info) { return info.param < 1e-6 ? "Fine" : "Default"; });

}  // namespace
}  // namespace cradle
