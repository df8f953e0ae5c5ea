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

// A box slides at v = 1 m/s into a wall and comes back at e v, so that the floor's friction at the end of the step
// drives it forwards, as it has moved in the mean: by mu m g h at (1 - e) v / 2, all of which the impact takes too.
TEST(ContactStepping, BooksWhatContactsTakeTogether) {
  const Scene scene = sceneWith(R"("duration": 1, "materials": {
      "rough": {"restitution": 0.5, "staticFriction": 0.3, "dynamicFriction": 0.3},
      "smooth": {"restitution": 0.5, "staticFriction": 0, "dynamicFriction": 0}},
    "bodies": [{"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "rough"},
      {"name": "wall", "shape": {"plane": {"normal": [-1, 0, 0]}}, "position": [0.2, 0, 0], "motion": "static",
       "material": "smooth"},
      {"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 3, "material": "rough",
       "position": [0, 0.1, 0], "linearVelocity": [1, 0, 0]}])");
  Assembly assembly = assemble(scene, wholeScene(scene));
  const VectorX before = assembly.state;
  BroadPhase broadPhase;
  broadPhase.update(before, {0}, 1e-9, assembly.geometry);
  std::vector<Contact> contacts;
  findContacts(assembly.geometry, before, 1e-9, contacts);
  ASSERT_EQ(contacts.size(), 8U);

  const double timeStep = 0.01;
  VectorX state = before;
  linearVelocity(state, 0).y() -= timeStep * kGravity;
  centerOfMass(state, 0) += 0.5 * timeStep * (linearVelocity(before, 0) + linearVelocity(state, 0));
  ContactStepping stepping(assembly);
  stepping.resolve(contacts, {}, before, timeStep, state);
  const Vec3 end = linearVelocity(state, 0);
  EXPECT_LT((end - Vec3(-0.5, 0, 0)).norm(), 1e-9);
  // The sum of what is taken is exact; 1e-9 m/s of the end velocity are 3e-9 J.
  EXPECT_NEAR(impactEnergy(state) + frictionEnergy(state), 0.5 * 3 * (1 - 0.5 * 0.5), 1e-8);
  EXPECT_EQ(frictionEnergy(state), 0);
}

}  // namespace
}  // namespace cradle
