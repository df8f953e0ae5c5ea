#include <gtest/gtest.h>

#include "core/error.h"
#include "experiments/experiment.h"
#include "simulate/assembly.h"

namespace cradle {
namespace {

std::string refusalOf(const Scene& scene) {
  try {
    refuseUnsupported(scene);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    return error.what();
  }
  return "";
}

Scene withBodies(const std::string& bodies, const std::string& more = "") {
  return sceneOf(R"({"schema": "cradle-scene/1", "name": "t", "duration": 1, "bodies": [)" + bodies + "]" + more + "}");
}

Assembly assemble(const Scene& scene) {
  return cradle::assemble(scene, wholeScene(scene));
}

TEST(Refusals, AreNoneAmongShapesOfAllKinds) {
  const char* const kShapes[] = {R"({"sphere": {"radius": 0.1}})", R"({"box": {"size": [1, 1, 1]}})",
                                 R"({"capsule": {"radius": 0.1, "length": 0.2}})",
                                 R"({"cylinder": {"radius": 0.1, "length": 0.2}})",
                                 R"({"plane": {"normal": [0, 1, 0]}})"};
  std::string bodies;
  int x = 0;
  for (const char* shape : kShapes)
    for (const char* motion : {"dynamic", "static"}) {
      if (std::string(shape).find("plane") != std::string::npos && std::string(motion) == "dynamic") continue;
      bodies += fmt::format(R"({}{{"name": "b{}", "shape": {}, "motion": "{}", "position": [{}, 0, 0]}})",
                            bodies.empty() ? "" : ",", x, shape, motion, 3 * x);
      ++x;
    }
  EXPECT_EQ(refusalOf(withBodies(bodies)), "");
}

TEST(Assembly, PutsAnchorsOfFixedBodiesIntoTheWorld) {
  const Assembly assembly =
      assemble(withBodies(R"({"name": "s", "shape": {"box": {"size": [1, 1, 1]}}, "motion": "static",
    "position": [1, 2, 3], "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}, "collision": "none"},
    {"name": "m", "shape": {"sphere": {"radius": 0.1}}, "collision": "none", "mass": 1, "centerOfMass": [0, 0.5, 0],
     "inertiaTensor": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]})",
                          R"(,
    "springs": [{"bodyA": "m", "anchorA": [0.25, 0, 0], "bodyB": "s", "anchorB": [0.5, 0, 0], "stiffness": 1}])"));
  ASSERT_EQ(assembly.mechanism.springs.size(), 1u);
  const SpringForce& spring = assembly.mechanism.springs[0];
  EXPECT_EQ(spring.anchorA.body, 0);
  EXPECT_LT((spring.anchorA.point - Vec3(0.25, -0.5, 0)).norm(), 1e-15) << "from the centre of mass";
  EXPECT_EQ(spring.anchorB.body, kFixed);
  EXPECT_LT((spring.anchorB.point - Vec3(1, 2.5, 3)).norm(), 1e-15);
  EXPECT_LT((Vec3(centerOfMass(assembly.state, 0)) - Vec3(0, 0.5, 0)).norm(), 1e-15);
}

TEST(Assembly, ProjectsStartVelocitiesAgainstARodAndSaysSo) {
  const Assembly assembly =
      assemble(withBodies(R"({"name": "m", "shape": {"sphere": {"radius": 0.1}}, "mass": 1,
    "linearVelocity": [3, 4, 0]})",
                          R"(, "rods": [{"bodyA": "m", "anchorA": [0, 0, 0], "anchorB": [0, 2, 0]}])"));
  EXPECT_LT((Vec3(linearVelocity(assembly.state, 0)) - Vec3(3, 0, 0)).norm(), 1e-14);
  ASSERT_EQ(assembly.warnings.size(), 1u);
  EXPECT_NE(assembly.warnings[0].find("rod \"rod0\" with 4 m/s"), std::string::npos) << assembly.warnings[0];
}

// Joined to the world at its edge, and given 3 m/s without the spin that would go with it: 3 m/s at the joint.
TEST(Assembly, SaysHowMuchStartVelocitiesWouldPullAJointApart) {
  for (const std::string kind : {"ballJoints", "hinges"}) {
    const Assembly assembly = assemble(
        withBodies(R"({"name": "m", "shape": {"sphere": {"radius": 0.1}}, "mass": 1,
      "linearVelocity": [3, 0, 0]})",
                   R"(, ")" + kind + R"(": [{"bodyA": "m", "anchorA": [0, 0.1, 0], "anchorB": [0, 0.1, 0]}])"));
    ASSERT_EQ(assembly.warnings.size(), 1u);
    EXPECT_NE(assembly.warnings[0].find(kind == "hinges" ? "pull joints apart, most of all hinge \"hinge0\" with 3 m/s"
                                                         : "most of all ball joint \"ballJoint0\" with 3 m/s"),
              std::string::npos)
        << assembly.warnings[0];
    const Vec3 velocity = linearVelocity(assembly.state, 0), spin = angularVelocity(assembly.state, 0);
    EXPECT_LT((velocity + spin.cross(Vec3(0, 0.1, 0))).norm(), 1e-14) << kind;
  }
}

TEST(Assembly, TakesPairSurfacesAndPutsPlanesSecond) {
  const Assembly assembly = assemble(withBodies(R"({"name": "p", "shape": {"plane": {"normal": [0, 0, 2]}},
    "motion": "static", "material": "ice", "position": [0, 0, -0.1]},
    {"name": "m", "shape": {"sphere": {"radius": 0.1}}, "material": "steel"})",
                                                R"(,
    "materials": {"ice": {}, "steel": {}},
    "pairs": [{"materials": ["steel", "ice"], "restitution": 0.7, "staticFriction": 0.2, "dynamicFriction": 0.1}])"));
  ASSERT_EQ(assembly.geometry.pairs.size(), 1u);
  EXPECT_TRUE(assembly.geometry.pairs[0].againstPlane);
  EXPECT_EQ(assembly.geometry.pairs[0].material.restitution, 0.7);
  EXPECT_EQ(assembly.geometry.pairs[0].material.dynamicFriction, 0.1);
  EXPECT_EQ(assembly.geometry.planes[0].normal, Vec3::UnitZ());
  EXPECT_EQ(bodiesOf(assembly, assembly.geometry.pairs[0]), std::make_pair(1, 0));
}

}  // namespace
}  // namespace cradle
