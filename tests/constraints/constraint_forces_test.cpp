#include "constraints/constraint_forces.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "constraints/constraint_row.h"
#include "constraints/tumbling_bodies.h"
#include "math/rotation.h"

namespace cradle {
namespace {

// Blocks are held against a dense matrix of the same rows one by one, each of which mechanism_test.cpp holds against
// differences of constraint errors.

/// Tumbling bodies that joints tie.
struct JointedBodies : TumblingBodies {
  Constraints constraints;
  std::vector<BodyFrame> frames;

  explicit JointedBodies(int count) : TumblingBodies(count) { findBodyFrames(bodies, state, frames); }

  /// Kinds in turn: a ball joint, a hinge, a rod, a slider, a weld.
  void tie(int bodyA, int bodyB) {
    const std::size_t number = constraints.size();
    if (number % 5 == 0) tie(bodyA, bodyB, BallJointConstraint());
    if (number % 5 == 1) tie(bodyA, bodyB, HingeConstraint{Vec3(2, 1, 2) / 3, {Vec3::UnitX(), Vec3::UnitZ()}});
    if (number % 5 == 2) tie(bodyA, bodyB, RodConstraint{0.8});
    if (number % 5 == 3) tie(bodyA, bodyB, SliderConstraint{{Vec3::UnitY(), Vec3::UnitZ()}, nearTurn(bodyA, bodyB)});
    if (number % 5 == 4) tie(bodyA, bodyB, WeldConstraint{nearTurn(bodyA, bodyB)});
  }
  /// An orientation of B as A sees it, not far from the one it has.
  Mat3 nearTurn(int bodyA, int bodyB) const {
    const auto turnOf = [this](int body) { return body == kFixed ? Quat::Identity() : Quat(orientation(state, body)); };
    const Quat turn = turnOf(bodyA).conjugate() * turnOf(bodyB) * rotationAbout(Vec3(2, -1, 1), 0.4);
    return turn.toRotationMatrix();
  }
  template <class Kind>
  void tie(int bodyA, int bodyB, const Kind& kind) {
    const double i = static_cast<double>(constraints.size());
    constraints.push_back({{bodyA, Vec3(0.3, -0.2 * i, 0.4)}, {bodyB, Vec3(-0.5, 0.1, 0.2 + 0.1 * i)}, kind});
  }
};

/// Holds accelerations, velocities and errors against the dense solution. Entries are of the size of 1 to 10, condition
/// numbers below 1e4.
void expectAsDense(const JointedBodies& jointed) {
  const std::vector<ConstraintRow> rows = rowsOf(jointed.constraints, jointed.state, jointed.frames);
  const Eigen::Index size = std::ssize(rows);
  ASSERT_EQ(size, rowCount(jointed.constraints));
  MatrixX matrix(size, size), responses(jointed.state.size(), size);
  VectorX rates(size), products(size), errors(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const ConstraintRow& row = rows[static_cast<std::size_t>(i)];
    responses.col(i) = responseTo(row, jointed.bodies, jointed.frames);
    for (Eigen::Index j = 0; j < size; ++j) matrix(j, i) = rateOf(rows[static_cast<std::size_t>(j)], responses.col(i));
    rates[i] = rateOf(row, jointed.state), products[i] = row.velocityProduct, errors[i] = row.value / row.scale;
  }
  ConstraintSolver solver(jointed.constraints, jointed.bodies);
  solver.factorize(jointed.state);
  EXPECT_NEAR(solver.largestError(), errors.cwiseAbs().maxCoeff(), 1e-13);

  const auto dense = matrix.partialPivLu();
  VectorX state = jointed.state;
  solver.constrainVelocities(state);
  EXPECT_LT((state - jointed.state + responses * dense.solve(rates)).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT(solver.largestRate(state).rate, 1e-11);

  // Accelerations as if the velocities were those of all bodies at once.
  VectorX derivative = jointed.state;
  const VectorX forces = solver.constrainAccelerations(derivative);
  const VectorX expected = dense.solve(-rates - products);
  EXPECT_LT((forces - expected).cwiseAbs().maxCoeff(), 1e-11 * expected.cwiseAbs().maxCoeff());
  EXPECT_LT((derivative - jointed.state - responses * expected).cwiseAbs().maxCoeff(),
            1e-11 * expected.cwiseAbs().maxCoeff());

  // Displacements that take out the errors, beside some that are there.
  VectorX displacement = jointed.state;
  solver.constrainDisplacements(displacement);
  for (Eigen::Index i = 0; i < size; ++i) errors[i] = rows[static_cast<std::size_t>(i)].value;
  const VectorX shortest = jointed.state - responses * dense.solve(rates + errors);
  EXPECT_LT((displacement - shortest).cwiseAbs().maxCoeff(), 1e-11 * shortest.cwiseAbs().maxCoeff());
}

TEST(ConstraintForces, OfAChainAreThoseOfADenseMatrix) {
  JointedBodies chain(5);
  chain.tie(0, kFixed), chain.tie(1, 0), chain.tie(1, 2), chain.tie(3, 2), chain.tie(kFixed, 3), chain.tie(3, 4);
  expectAsDense(chain);
}

TEST(ConstraintForces, OfATreeWithAnchorsAtCentersOfMassAreThoseOfADenseMatrix) {
  JointedBodies tree(5);
  tree.tie(0, kFixed), tree.tie(1, 0), tree.tie(2, 0), tree.tie(0, 3), tree.tie(4, 3);
  for (Constraint& constraint : tree.constraints) constraint.anchorB.point.setZero();
  tree.constraints[0].anchorA.point.setZero();
  expectAsDense(tree);
}

/// Eliminating a constraint of a ring fills in what was empty.
TEST(ConstraintForces, OfARingAreThoseOfADenseMatrix) {
  JointedBodies ring(8);
  for (int i = 0; i < 8; ++i) ring.tie(i, (i + 1) % 8);
  ring.tie(2, kFixed);
  expectAsDense(ring);
}

/// Two rods between the same bodies have both in common.
TEST(ConstraintForces, OfTwoConstraintsBetweenTheSameBodiesAreThoseOfADenseMatrix) {
  JointedBodies two(2);
  for (int i = 0; i < 3; ++i) two.tie(i % 2, 1 - i % 2, RodConstraint{0.7});
  expectAsDense(two);
}

TEST(ConstraintForces, FollowAChangeOfWhatIsTied) {
  JointedBodies tied(3), fresh(3);
  ConstraintSolver solver(tied.constraints, tied.bodies);
  tied.tie(0, 1), tied.tie(1, 2);
  solver.factorize(tied.state);
  tied.constraints.clear();
  for (JointedBodies* each : {&tied, &fresh}) each->tie(kFixed, 1), each->tie(1, 2), each->tie(0, 2);
  ConstraintSolver another(fresh.constraints, fresh.bodies);
  solver.factorize(tied.state), another.factorize(fresh.state);
  solver.constrainVelocities(tied.state), another.constrainVelocities(fresh.state);
  EXPECT_EQ(tied.state, fresh.state);
}

/// A joint that is there twice does what one does.
TEST(ConstraintForces, TwoEqualJointsDoWhatOneDoes) {
  JointedBodies one(2), two(2);
  one.tie(0, 1);
  two.constraints = {one.constraints[0], one.constraints[0]};
  ConstraintSolver single(one.constraints, one.bodies), twin(two.constraints, two.bodies);
  single.factorize(one.state), twin.factorize(two.state);
  single.constrainVelocities(one.state), twin.constrainVelocities(two.state);
  EXPECT_LT((one.state - two.state).cwiseAbs().maxCoeff(), 1e-12);
}

/// A rope beside joints goes taut and slack again.
// A light body between the world and a heavier one takes its part of the velocities exactly: all that rounding leaves
// of what its joints close by is 1e-16 times the ratio of the masses.
TEST(ConstraintForces, HoldLightBodiesBetweenHeavyOnes) {
  for (const double lightness : {1e-3, 1e-5, 1e-6, 1e-7}) {
    JointedBodies at(2);
    at.bodies[0] =
        makeRigidBody({lightness, Vec3::Zero(), lightness * Vec3(0.1, 0.2, 0.25).asDiagonal().toDenseMatrix()});
    findBodyFrames(at.bodies, at.state, at.frames);
    at.tie(0, kFixed, BallJointConstraint());
    at.tie(1, 0, HingeConstraint{Vec3(2, 1, 2) / 3, {Vec3::UnitX(), Vec3::UnitZ()}});
    ConstraintSolver solver(at.constraints, at.bodies);
    solver.factorize(at.state);
    const double before = solver.largestRate(at.state).rate;
    solver.constrainVelocities(at.state);
    EXPECT_GT(before, 1);
    EXPECT_LT(solver.largestRate(at.state).rate, 1e-14 / lightness) << lightness;
  }
}

/// A light body that a hinge and its stop hold, and a body of 1 kg that turns about it by a second hinge along z, at
/// the speed `spin` (rad/s).
struct HeldLightBody {
  std::vector<RigidBody> bodies;
  VectorX state = VectorX::Zero(stateSize(2));
  Constraints constraints;
  Vec3 pivot = Vec3(0.5, 0, 0.1), arm = Vec3(0.4, 0.3, -0.1);  // m: of the second hinge; from there to body 1

  HeldLightBody(double lightness, double spin) {
    const Mat3 inertia = Vec3(0.001, 0.02, 0.025).asDiagonal();
    bodies = {makeRigidBody({lightness, Vec3::Zero(), lightness * inertia}),
              makeRigidBody({1, Vec3::Zero(), Vec3(0.1, 0.2, 0.25).asDiagonal().toDenseMatrix()})};
    for (const int body : {0, 1}) setOrientation(state, body, Quat::Identity());
    centerOfMass(state, 1) = pivot + arm;
    angularVelocity(state, 1) = spin * Vec3::UnitZ();
    linearVelocity(state, 1) = spin * Vec3::UnitZ().cross(arm);
    const HingeConstraint hinge{Vec3(2, 1, 2) / 3, {Vec3(2, -2, -1) / 3, Vec3(1, 2, -2) / 3}};
    const Vec3 wall(-0.3, 0.1, 0.2);
    const Attachment light{0, wall}, world{kFixed, wall};
    constraints.push_back({light, world, hinge});
    constraints.push_back({light, world, JointCoordinate{true, hinge.axisA, hinge.acrossB[0], hinge.acrossB[0]}});
    constraints.push_back({{1, -arm}, {0, pivot}, HingeConstraint{Vec3::UnitZ(), {Vec3::UnitX(), Vec3::UnitY()}}});
  }
};

// The forces on the light body are those that move the heavy one, and cancel. What they would move it by one after the
// other, and the small part that is left of the heavy body in J M^-1 J^T, is no contradiction of the joints: errors go
// to rounding, and the light body stays where its joint and stop hold it.
TEST(ConstraintForces, ProjectAHeavyBodyTiedToALightOne) {
  for (const double lightness : {1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    HeldLightBody held(lightness, 3);
    centerOfMass(held.state, 1) += 1e-6 * Vec3(1, 2, 3);
    turnBody(held.state, 1, 1e-6 * Vec3(3, -1, 2));
    ConstraintSolver solver(held.constraints, held.bodies);
    EXPECT_GT(solver.project(held.state), 1e-7);
    EXPECT_LT(solver.largestError(), 1e-14) << lightness;
    EXPECT_FALSE(solver.leaveNoMotion(held.state, 0)) << lightness;
    EXPECT_LT(centerOfMass(held.state, 0).norm(), 1e-14) << lightness;
  }
}

// Of a physical pendulum: a'' = -m g r_x / (I + m r^2), whatever holds its pivot. By the light body's arms and inertia,
// W has entries of 1e3 / lightness; they are rounded, and the force that holds the pivot is 10 N: 1e-12 / lightness.
TEST(ConstraintForces, LetAHeavyBodySwingOnALightOneThatIsHeld) {
  for (const double lightness : {1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    HeldLightBody held(lightness, 3);
    ConstraintSolver solver(held.constraints, held.bodies);
    solver.factorize(held.state);
    VectorX derivative = VectorX::Zero(held.state.size());
    for (const int body : {0, 1}) linearVelocity(derivative, body) = Vec3(0, -9.81, 0);
    solver.constrainAccelerations(derivative);
    const double acceleration = -9.81 * held.arm.x() / (0.25 + held.arm.head<2>().squaredNorm());
    EXPECT_NEAR(angularVelocity(derivative, 1).z(), acceleration, 1e-12 / lightness) << lightness;
    EXPECT_LT(linearVelocity(derivative, 0).norm(), 1e-12 / lightness) << lightness;
  }
}

// A joint that is there twice contradicts nothing, however light the body is that it holds.
TEST(ConstraintForces, FindNoContradictionInMasses) {
  for (const double lightness : {1.0, 1e-2, 1e-4, 1e-6, 1e-8}) {
    HeldLightBody held(lightness, 3);
    held.constraints.push_back(held.constraints[0]);
    centerOfMass(held.state, 1) += 1e-9 * Vec3(1, 2, 3);
    ConstraintSolver solver(held.constraints, held.bodies);
    solver.factorize(held.state);
    EXPECT_FALSE(solver.leaveNoMotion(held.state, 0)) << lightness;
  }
}

// Two bars of 1 m in line between fixed points that are 2 m and 1e-9 m apart: their knee would leave the line, and
// nothing can turn it, whatever the bars weigh.
TEST(ConstraintForces, FindBarsAtTheirFullLengthLocked) {
  for (const double lightness : {1.0, 1e-2, 1e-4, 1e-6}) {
    HeldLightBody bars(lightness, 0);
    for (const int body : {0, 1}) {
      const double spin = body == 0 ? 2 : -2;
      centerOfMass(bars.state, body) = Vec3(0.5 + body, 0, 0);
      linearVelocity(bars.state, body) = Vec3(0, 1, 0), angularVelocity(bars.state, body) = Vec3(0, 0, spin);
    }
    const Vec3 end(0.5, 0, 0);
    bars.constraints = {{{0, -end}, {kFixed, Vec3::Zero()}, BallJointConstraint()},
                        {{0, end}, {1, -end}, BallJointConstraint()},
                        {{1, end}, {kFixed, Vec3(2 + 1e-9, 0, 0)}, BallJointConstraint()}};
    ConstraintSolver solver(bars.constraints, bars.bodies);
    solver.factorize(bars.state);
    EXPECT_TRUE(solver.leaveNoMotion(bars.state, 0)) << lightness;
  }
}

// Bodies that nothing turns: of a hinge, the rows of rotations ask for what they do not get. The others are kept all
// the same, whatever is asked of those, but for rounding times the ratio of the masses.
TEST(ConstraintForces, KeepPointsOfBodiesThatNothingTurns) {
  for (const double spin : {1.0, 1e3}) {
    JointedBodies at(3);
    for (RigidBody& body : at.bodies) body.inverseInertia.setZero();
    at.bodies[0].inverseMass *= 3000;
    findBodyFrames(at.bodies, at.state, at.frames);
    angularVelocity(at.state, 1) *= spin;
    at.tie(0, kFixed, BallJointConstraint());
    at.tie(1, 0, HingeConstraint{Vec3(2, 1, 2) / 3, {Vec3::UnitX(), Vec3::UnitZ()}});
    at.tie(2, 1, BallJointConstraint());
    ConstraintSolver solver(at.constraints, at.bodies);
    solver.factorize(at.state);
    solver.constrainVelocities(at.state);
    const std::vector<ConstraintRow> rows = rowsOf(at.constraints, at.state, at.frames);
    ASSERT_EQ(rows.size(), 11u);
    for (const std::size_t row : {0u, 1u, 2u, 3u, 4u, 5u, 8u, 9u, 10u})
      EXPECT_NEAR(rateOf(rows[row], at.state), 0, 1e-11 * spin) << row << " " << spin;
    EXPECT_GT(std::abs(rateOf(rows[6], at.state)), 0.01);
  }
}

TEST(ConstraintForces, HaveAMultiplierForEachRowWhateverWasTiedBefore) {
  JointedBodies jointed(2);
  jointed.tie(0, 1);
  const Constraint rod{{0, Vec3(0.1, 0.2, 0.3)}, {kFixed, Vec3(1, 2, 3)}, RodConstraint{2}};
  ConstraintSolver solver(jointed.constraints, jointed.bodies);
  VectorX rate = VectorX::Zero(jointed.state.size());
  for (const bool isTaut : {true, false, true}) {
    jointed.constraints.resize(1);
    if (isTaut) jointed.constraints.push_back(rod);
    solver.factorize(jointed.state);
    EXPECT_EQ(solver.constrainAccelerations(rate).size(), isTaut ? 4 : 3);
  }
}

/// Bodies that are left out keep their velocities, and what ties them ties nobody.
TEST(ConstraintForces, LeaveOutTheRowsOfExcludedBodies) {
  JointedBodies jointed(3), alone(3);
  jointed.tie(0, kFixed), jointed.tie(0, 1), jointed.tie(1, 2);
  alone.tie(0, kFixed);
  ConstraintSolver solver(jointed.constraints, jointed.bodies), single(alone.constraints, alone.bodies);
  solver.exclude({0, 1, 0});
  solver.factorize(jointed.state), single.factorize(alone.state);
  solver.constrainVelocities(jointed.state), single.constrainVelocities(alone.state);
  EXPECT_EQ(jointed.state, alone.state);
}

// A fixed body moves no more than the world: the same multipliers and velocities come out where its anchors are the
// world's. Rows among fixed bodies are left out.
TEST(ConstraintForces, HaveFixedBodiesActAsTheWorld) {
  JointedBodies jointed(4);
  jointed.tie(0, 1), jointed.tie(1, 2), jointed.tie(3, 0);
  jointed.tie(2, kFixed, BallJointConstraint());
  for (const int body : {2, 3})
    linearVelocity(jointed.state, body).setZero(), angularVelocity(jointed.state, body).setZero();
  JointedBodies world = jointed;
  world.constraints.pop_back();
  for (Constraint& constraint : world.constraints)
    for (Attachment* const anchor : {&constraint.anchorA, &constraint.anchorB})
      if (anchor->body >= 2) *anchor = {kFixed, motionOf(*anchor, jointed.state).position};
  auto& hinge = std::get<HingeConstraint>(world.constraints[1].kind);
  for (Vec3& across : hinge.acrossB) across = orientation(jointed.state, 2) * across;
  ConstraintSolver solver(jointed.constraints, jointed.bodies), expected(world.constraints, world.bodies);
  solver.exclude({}, {0, 0, 1, 1});
  solver.factorize(jointed.state), expected.factorize(world.state);
  VectorX derivative = jointed.state, expectedDerivative = derivative;
  const VectorX forces = solver.constrainAccelerations(derivative);
  const VectorX expectedForces = expected.constrainAccelerations(expectedDerivative);
  ASSERT_EQ(forces.size(), expectedForces.size());
  EXPECT_LT((forces - expectedForces).cwiseAbs().maxCoeff(), 1e-11 * forces.cwiseAbs().maxCoeff());
  EXPECT_LT((derivative - expectedDerivative).cwiseAbs().maxCoeff(), 1e-11 * derivative.cwiseAbs().maxCoeff());
  VectorX all = VectorX::Constant(rowCount(jointed.constraints), -7);
  solver.putMultipliers(all);
  EXPECT_EQ(all.head(forces.size()), forces);
  EXPECT_EQ(all.tail(3), Eigen::Vector3d::Constant(-7));  // of the ball joint between a fixed body and the world
}

// Of a ball joint to the world, a hinge and a rod the first and the last belong to body 0 alone.
TEST(ConstraintForces, PutMultipliersInThePlacesOfTheirRows) {
  JointedBodies jointed(3);
  jointed.tie(0, kFixed), jointed.tie(1, 2), jointed.tie(0, kFixed);
  ConstraintSolver solver(jointed.constraints, jointed.bodies);
  solver.exclude({0, 1, 0});
  solver.factorize(jointed.state);
  VectorX derivative = jointed.state, all = VectorX::Constant(9, -7);
  const VectorX forces = solver.constrainAccelerations(derivative);
  ASSERT_EQ(forces.size(), 4);
  solver.putMultipliers(all);
  EXPECT_EQ(all.head(3), forces.head(3));
  EXPECT_EQ(all.segment(3, 5), VectorX::Constant(5, -7));
  EXPECT_EQ(all[8], forces[3]);
}

}  // namespace
}  // namespace cradle
