#include "simulate/steps/contact_stepping.h"

#include <gmock/gmock.h>

#include "collision/broad_phase.h"
#include "experiments/experiment.h"
#include "simulate/assembly.h"

namespace cradle {
namespace {

// A ball on the floor hangs from a joint beneath it: along the arm nothing moves it, and that direction lies within the
// cone of friction. While it turns towards the floor, a step's free motion leads along the arm by what the turn is
// worth. Then no impulse stops it: what stops the ball drives it along the arm, and the search for more goes beyond all
// bounds.
TEST(ContactStepping, LeavesOutImpulsesThatAreWorseThanNone) {
  const Scene scene = sceneWith(R"("duration": 1, "gravity": [0, 0, 0],
    "materials": {"rough": {"restitution": 0, "staticFriction": 0.6, "dynamicFriction": 0.6}},
    "bodies": [{"name": "floor", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static", "material": "rough"},
      {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "material": "rough", "position": [0.3, 0.1, 0],
       "linearVelocity": [1.1, -0.3, 0], "angularVelocity": [0, 0, -1]}],
    "ballJoints": [{"bodyA": "ball", "anchorA": [-0.3, -1.1, 0], "anchorB": [0, -1, 0]}])");
  Assembly assembly = assemble(scene, wholeScene(scene));
  const VectorX before = assembly.state;
  BroadPhase broadPhase;
  broadPhase.update(before, {0}, 1e-9, assembly.geometry);
  std::vector<Contact> contacts;
  findContacts(assembly.geometry, before, 1e-9, contacts);
  ASSERT_EQ(contacts.size(), 1U);

  const double timeStep = 1e-3;
  VectorX state = before;
  linearVelocity(state, 0) -= timeStep * Vec3(0.3, 1.1, 0);  // 1 rad/s, towards the joint
  ContactStepping stepping(assembly);
  stepping.resolve(contacts, {}, before, timeStep, state);
  EXPECT_LT((centerOfMass(state, 0) - centerOfMass(before, 0)).norm(), 2 * timeStep);  // at 1.14 m/s
  EXPECT_LE(kineticEnergy(assembly.mechanism.bodies[0], 0, state),
            kineticEnergy(assembly.mechanism.bodies[0], 0, before));
  EXPECT_GE(linearVelocity(state, 0).y(), -1e-9);  // and yet the floor stops it
}

}  // namespace
}  // namespace cradle
