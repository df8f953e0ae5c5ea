#include "impact/frictional_contact.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include "impact/friction_cone.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kGravity = 9.81;  // m/s^2

/// A problem of bodies: rows of contacts by velocities of bodies, and inverse masses of these.
struct Rows {
  MatrixX j;
  VectorX inverseMasses, velocities;
  std::vector<double> frictions;

  MatrixX matrix() const { return j * inverseMasses.asDiagonal() * j.transpose(); }
  VectorX free() const { return j * velocities; }
  ContactSolution solve() const { return solveFrictionalContact(matrix(), free(), frictions); }
  VectorX velocitiesAfter(const ContactSolution& solution) const {
    return velocities + inverseMasses.asDiagonal() * (j.transpose() * solution.impulses);
  }
};

/// Cubes of edge 1 standing on each other, contacts at the corners of each one's lower face; axes t1, t2, n.
Rows stackOf(const std::vector<double>& masses, double friction) {
  const Eigen::Index count = std::ssize(masses);
  Rows rows{MatrixX::Zero(12 * count, 6 * count), VectorX(6 * count), VectorX::Zero(6 * count), {}};
  rows.frictions.assign(4 * masses.size(), friction);
  for (Eigen::Index body = 0; body < count; ++body) {
    const double mass = masses[static_cast<std::size_t>(body)];
    rows.inverseMasses.segment<6>(6 * body) << Vec3::Constant(1 / mass), Vec3::Constant(6 / mass);
    for (int corner = 0; corner < 4; ++corner)
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 arm((corner & 1) - 0.5, (corner >> 1) - 0.5, -0.5), below = arm + Vec3::UnitZ();
        const Vec3 direction = Vec3::Unit(axis);
        auto row = rows.j.row(3 * (4 * body + corner) + axis);
        row.segment<3>(6 * body) = direction, row.segment<3>(6 * body + 3) = arm.cross(direction);
        if (body == 0) continue;
        row.segment<3>(6 * body - 6) = -direction, row.segment<3>(6 * body - 3) = -below.cross(direction);
      }
  }
  return rows;
}

/// What Coulomb's law asks of each contact, to `tolerance`, for velocities and impulses of about 1.
void expectCoulomb(const ContactSolution& solution, const std::vector<double>& frictions, double tolerance) {
  for (Eigen::Index i = 0; i < std::ssize(frictions); ++i) {
    const Vec3 z = solution.impulses.segment<3>(3 * i), u = solution.velocities.segment<3>(3 * i);
    const double limit = frictions[static_cast<std::size_t>(i)] * z.z();
    EXPECT_GE(z.z(), 0);
    EXPECT_GE(u.z(), -tolerance);
    EXPECT_NEAR(std::min(u.z(), z.z()), 0, tolerance);
    EXPECT_LE(z.head<2>().norm(), limit + tolerance);
    // It slides at the limit, against the sliding; z . u is then -limit |u|.
    if (u.head<2>().norm() > 10 * tolerance) {
      EXPECT_NEAR(z.head<2>().dot(u.head<2>()), -limit * u.head<2>().norm(), tolerance * (1 + u.norm()));
    }
  }
}

// A ball of radius r and mass m thrown onto a floor: its surface point answers with (1/m)(1 + r^2 m / I) = 3.5/m along
// the floor and 1/m across. Sticking takes -m u_t / 3.5.
TEST(ConeProblem, OneBallSticksSlidesOrLeaves) {
  const double mass = 2;
  const MatrixX g = Vec3(3.5 / mass, 3.5 / mass, 1 / mass).asDiagonal();
  const VectorX sticking = solveFrictionalContact(g, Vec3(0.3, 0.4, -1), {0.2}).impulses;
  EXPECT_LT((sticking - mass * Vec3(-0.3 / 3.5, -0.4 / 3.5, 1)).norm(), 1e-15);
  const ContactSolution sliding = solveFrictionalContact(g, Vec3(3, 4, -1), {0.2});
  EXPECT_LT((sliding.impulses - mass * Vec3(-0.6 * 0.2, -0.8 * 0.2, 1)).norm(), 1e-14);
  EXPECT_LT((sliding.velocities - Vec3(3 - 3.5 * 0.12, 4 - 3.5 * 0.16, 0)).norm(), 1e-14);
  EXPECT_EQ(solveFrictionalContact(g, Vec3(3, 4, 1), {0.2}).impulses, Vec3::Zero());
  EXPECT_TRUE(sliding.converged);
}

// A body on a ball joint cannot give way along the lever r from the joint to the contact: (r.r - r r^T) / I. A rebound
// asks for velocities that nothing can bring about; friction slides then, however strong it would have to be to hold.
TEST(ConeProblem, OneContactOfABodyOnABallJointSlides) {
  for (const Vec3& lever : {Vec3(0.1, 0.2, 0.3), Vec3(-0.4, 0.1, 0.05), Vec3(0, 0.3, -0.3)}) {
    const MatrixX g = (lever.squaredNorm() * Mat3::Identity() - lever * lever.transpose()) / 0.2;
    const VectorX free = Vec3(-2.2, -2.4, -4.1);
    const ContactSolution solution = solveFrictionalContact(g, free, {0.05});
    ASSERT_TRUE(solution.impulses.allFinite()) << lever.transpose();
    expectCoulomb(solution, {0.05}, 1e-9);  // impulses of some ten N s: rounding, thousandfold by the singular matrix
  }
}

TEST(ConeProblem, NothingToPushIsSaid) {
  EXPECT_FALSE(solveFrictionalContact(Mat3::Zero(), Vec3(0, 0, -1), {0.5}).converged);
  EXPECT_TRUE(solveFrictionalContact(MatrixX::Zero(6, 6), VectorX::Zero(6), {0.5, 0.5}).converged);
}

// A box on a slope of angle a: at rest if tan(a) <= mu; else it slides with g (sin a - mu cos a).
TEST(ConeProblem, BoxOnASlopeSlidesBeyondTheAngleOfFriction) {
  for (const double friction : {0.1, 0.5, 0.7})  // beyond 1 it would tip over its edge first
    for (const double part : {1 - 1e-9, 1 + 1e-9, 1.1}) {
      const double slope = part * friction, cosine = 1 / std::sqrt(1 + slope * slope);
      Rows box = stackOf({3}, friction);
      box.velocities.head<3>() = kGravity * cosine * Vec3(slope * 0.6, slope * 0.8, -1);
      const ContactSolution solution = box.solve();
      const VectorX acceleration = box.velocitiesAfter(solution);
      EXPECT_TRUE(solution.converged);
      const double expected = kGravity * cosine * std::max(0.0, slope - friction);
      // 1e-12 of the accelerations is what is promised at each contact.
      EXPECT_LT((acceleration.head<3>() - expected * Vec3(0.6, 0.8, 0)).norm(), 1e-11 * kGravity) << part;
      EXPECT_LT(acceleration.tail<3>().norm(), 1e-11 * kGravity);
    }
}

/// Contacts of bodies that know nothing of each other's shape: the hardest ones.
Rows randomRows(int contacts, int freedoms, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Rows rows{MatrixX(3 * contacts, freedoms), VectorX(freedoms), VectorX(freedoms), {}};
  for (double& entry : rows.j.reshaped()) entry = uniform(random);
  for (double& entry : rows.inverseMasses) entry = 1 + 0.9 * uniform(random);
  for (double& entry : rows.velocities) entry = uniform(random);
  for (int i = 0; i < contacts; ++i) rows.frictions.push_back(i % 5 == 0 ? 0 : 0.5 + 0.5 * uniform(random));
  return rows;
}

TEST(ConeProblem, RandomContactsObeyCoulomb) {
  std::mt19937 random(1);
  for (const int contacts : {1, 2, 4, 8})
    for (const int freedoms : {6, 2 * contacts + 4, 3 * contacts + 3})
      for (int trial = 0; trial < 20; ++trial) {
        const Rows rows = randomRows(contacts, freedoms, random);
        const ContactSolution solution = rows.solve();
        EXPECT_TRUE(solution.converged) << contacts << " " << freedoms << " " << trial;
        // 1e-12 of the velocities in scaled units; what is singular by chance has impulses of up to 1e2.
        expectCoulomb(solution, rows.frictions, 1e-9);
        EXPECT_LT((rows.j * rows.velocitiesAfter(solution) - solution.velocities).norm(), 1e-10);
      }
}

TEST(ConeProblem, DoesNotDependOnUnits) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Rows rows = randomRows(4, 12, random);
    const ContactSolution one = rows.solve();
    const ContactSolution other = solveFrictionalContact(1e6 * rows.matrix(), 1e-9 * rows.free(), rows.frictions);
    // Both are within 1e-12 of a solution that is unique here; conditions of up to 1e3.
    EXPECT_LT((1e15 * other.impulses - one.impulses).norm(), 1e-8 * one.impulses.norm() + 1e-300) << trial;
    EXPECT_LT((1e9 * other.velocities - one.velocities).norm(), 1e-8) << trial;
  }
}

// Light bodies carry heavy ones: a stack of ten with a top of 1000 times the mass stands, its accelerations zero to
// the rounding of forces that are 1000 times the weight of the others.
TEST(ConeProblem, AStackCarriesAHeavyTop) {
  for (const double top : {1.0, 1000.0}) {
    std::vector<double> masses(10, 1.0);
    masses.back() = top;
    Rows stack = stackOf(masses, 0.5);
    for (Eigen::Index body = 0; body < 10; ++body) stack.velocities[6 * body + 2] = -kGravity;
    const ContactSolution solution = stack.solve();
    EXPECT_TRUE(solution.converged);
    EXPECT_LT(stack.velocitiesAfter(solution).cwiseAbs().maxCoeff(), 1e-10 * kGravity);
    double carried = 0;
    for (int corner = 0; corner < 4; ++corner) carried += solution.impulses[3 * corner + 2];
    EXPECT_NEAR(carried, (9 + top) * kGravity, 1e-11 * (9 + top) * kGravity);
  }
}

// A cube thrown so that it is its own mirror image at y = 0: contacts 2 and 3 are the images of 0 and 1.
TEST(ConeProblem, WhatIsMirrorSymmetricStaysSo) {
  Rows cube = stackOf({1}, 0.4);
  cube.velocities << 0.7, 0, -1, 0, 0.9, 0;  // forward, down, tumbling forward: its own mirror image
  const ContactSolution solution = cube.solve();
  ASSERT_TRUE(solution.converged);
  const VectorX after = cube.velocitiesAfter(solution);
  EXPECT_LT(Vec3(after[1], after[3], after[5]).norm(), 1e-13);
  // Which of redundant contacts pushes how much is left to rounding over 1e-9 of the inverse mass.
  for (const int corner : {0, 1}) {
    const Vec3 image = solution.impulses.segment<3>(3 * (corner + 2)).cwiseProduct(Vec3(1, -1, 1));
    EXPECT_LT((solution.impulses.segment<3>(3 * corner) - image).norm(), 1e-7);
  }
}

/// A plank of 0.5 x 0.3 x 0.1 m and 15 kg that an edge at x = -0.09 carries under its lower face, while the corners of
/// its end at x = 0.25 stand on the ground, with a tilt of 0.01 down to this end; axes t1 = x, t2 = y, n = z. Contacts
/// 1 and 3 are the images of 0 and 2.
Rows plankOnTwoSupports(double friction) {
  Rows rows{MatrixX(12, 6), VectorX(6), VectorX(6), std::vector<double>(4, friction)};
  const double mass = 15, a = 0.5, b = 0.3, c = 0.1;
  rows.inverseMasses << Vec3::Constant(1 / mass),
      12 / mass * Vec3(1 / (b * b + c * c), 1 / (a * a + c * c), 1 / (a * a + b * b));
  rows.velocities << 0, 0, -9.81, 0, 0, 0;
  const Vec3 arms[] = {{0.25, -0.15, -0.05}, {0.25, 0.15, -0.05}, {-0.09, -0.15, -0.05}, {-0.09, 0.15, -0.05}};
  const Mat3 tilt = rotationAbout(Vec3::UnitY(), 0.01).toRotationMatrix();
  for (Eigen::Index row = 0; row < 12; ++row) {
    const Vec3 direction = row < 6 ? Vec3(Vec3::Unit(row % 3)) : Vec3(tilt.col(row % 3));
    rows.j.row(row) << direction.transpose(), arms[row / 3].cross(direction).transpose();
  }
  return rows;
}

// A cube of 1 kg and 1 m on its corners, pushed through its middle by F along x: corners that give way equally carry
// (m g -+ F) / 4. It slides from F = mu m g on, with (F - mu m g) / m. Residuals are 1e-12 of the velocities.
TEST(SharedContact, CarriesAPushAndSlidesByTheClosedForm) {
  Rows cube = stackOf({1}, 0.4);
  for (const double push : {0.1, 0.5, 1 - 1e-9, 1 + 1e-9, 1 + 1e-5, 1.5}) {
    const double force = push * 0.4 * kGravity;
    cube.velocities << force, 0, -kGravity, 0, 0, 0;
    const ContactSolution solution = solveSharedContact(cube.matrix(), cube.free(), cube.frictions, {}, {});
    ASSERT_TRUE(solution.converged) << push;
    const double sliding = std::max(0.0, force - 0.4 * kGravity);
    for (Eigen::Index i = 0; i < 4; ++i) {
      EXPECT_NEAR(solution.impulses[3 * i + 2], (kGravity + (i & 1 ? 1 : -1) * (force - sliding)) / 4, 1e-7) << push;
      EXPECT_LT((solution.velocities.segment<3>(3 * i) - Vec3(sliding, 0, 0)).norm(), 1e-12) << push;
    }
  }
}

// The same twisted by T about the vertical through its middle: four corners on m g / 4 each hold up to mu m g r.
TEST(SharedContact, TurnsByTheClosedForm) {
  Rows cube = stackOf({1}, 0.4);
  const double limit = 0.4 * kGravity * std::sqrt(0.5);
  for (const double twist : {0.5, 1 - 1e-9, 1 + 1e-9, 1 + 1e-5, 2.0}) {
    cube.velocities << 0, 0, -kGravity, 0, 0, 6 * twist * limit;
    const ContactSolution solution = solveSharedContact(cube.matrix(), cube.free(), cube.frictions, {}, {});
    ASSERT_TRUE(solution.converged) << twist;
    const VectorX after = cube.velocitiesAfter(solution);
    EXPECT_NEAR(after[5], 6 * std::max(0.0, (twist - 1) * limit), 1e-12) << twist;
    EXPECT_LT(after.head<5>().norm(), 1e-12) << twist;
  }
}

// A corner that would have to pull carries nothing, and goes on doing so: the others then are determined.
TEST(SharedContact, LeavesACornerIdle) {
  Rows cube = stackOf({1}, 0.8);
  cube.velocities << 0.6 * kGravity, 0.5 * kGravity, -kGravity, 0, 0, 0;
  const ContactSolution solution = solveSharedContact(cube.matrix(), cube.free(), cube.frictions, {}, {});
  ASSERT_TRUE(solution.converged);
  // About the middle: N3 - N1 + ... = 0.6 m g along x, 0.5 m g along y, m g in all, with corner 0 idle.
  const double expected[] = {0, 0.25, 0.2, 0.55};
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(solution.impulses[3 * i + 2], expected[i] * kGravity, 1e-7) << i;
    EXPECT_LT(solution.velocities.segment<3>(3 * i).norm(), 1e-12) << i;
  }
}

// The end slides back on the ground, and the plank forward over the edge. Rounds of friction from normal forces, and
// these from friction, leave the mirror image; the forces that are their own image are a solution too.
TEST(SlidingContact, WhatIsMirrorSymmetricStaysSo) {
  const Rows plank = plankOnTwoSupports(0.5);
  const Eigen::Vector2d forward = Eigen::Vector2d::UnitX();
  const std::vector<Eigen::Vector2d> directions{-forward, -forward, forward, forward};
  const VectorX start = solveFrictionalContact(plank.matrix(), plank.free(), std::vector<double>(4, 0.0)).impulses;
  const ContactSolution solution =
      solveSlidingContact(plank.matrix(), plank.free(), plank.frictions, directions, start);
  ASSERT_TRUE(solution.converged);
  const VectorX after = plank.velocitiesAfter(solution);
  EXPECT_LT(Vec3(after[1], after[3], after[5]).norm(), 1e-10);  // a residual of 1e-12 of gravity, over arms of 0.1 m
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Vec3 force = solution.impulses.segment<3>(3 * i);
    EXPECT_GE(force.z(), 0);
    EXPECT_NEAR(force.x(), i < 2 ? 0.5 * force.z() : -0.5 * force.z(), 1e-10);
    EXPECT_NEAR(force.y(), 0, 1e-10);
    EXPECT_GE(solution.velocities[3 * i + 2], -1e-10);
    EXPECT_NEAR(force.z() * solution.velocities[3 * i + 2], 0, 1e-9);
  }
}

// A rod that leans forward under 45 degrees and slides on its lower end with mu = 3: friction presses it down more than
// the normal force lifts it, 1 + 3 cos^2 - 3 mu sin cos < 0 (P. Painleve, 1895).
TEST(SlidingContact, ThatJamsIsSaid) {
  Rows rod{MatrixX(3, 3), Vec3(1, 1, 12), Vec3(0, -9.81, 0), {3.0}};  // x, up, angle; of 1 kg and 1 m
  const double arm = 0.5 * std::sqrt(0.5);
  rod.j << 1, 0, arm, 0, 0, 0, 0, 1, arm;
  const std::vector<Eigen::Vector2d> forward{Eigen::Vector2d::UnitX()}, back{-Eigen::Vector2d::UnitX()};
  const VectorX start = Vec3(0, 0, 1);
  EXPECT_FALSE(solveSlidingContact(rod.matrix(), rod.free(), {3.0}, forward, start).converged);
  const ContactSolution pulled = solveSlidingContact(rod.matrix(), rod.free(), {3.0}, back, start);
  ASSERT_TRUE(pulled.converged);
  EXPECT_NEAR(pulled.impulses[2], 9.81 / (1 + 12 * arm * arm * (1 + 3)), 1e-12);
}

/// A problem as contact_problems.txt has it.
struct PosedProblem {
  std::string name;
  MatrixX g;
  VectorX free;
  std::vector<double> frictions;
};

std::vector<PosedProblem> posedProblems() {
  std::ifstream file(CRADLE_SOURCE_DIR "/tests/impact/contact_problems.txt");
  while (file.peek() == '#') file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  std::vector<PosedProblem> problems;
  PosedProblem problem;
  for (Eigen::Index contacts = 0; file >> problem.name >> contacts;) {
    problem.frictions.resize(static_cast<std::size_t>(contacts));
    problem.free.resize(3 * contacts), problem.g.resize(3 * contacts, 3 * contacts);
    for (double& friction : problem.frictions) file >> friction;
    for (double& velocity : problem.free) file >> velocity;
    for (Eigen::Index row = 0; row < 3 * contacts; ++row)
      for (Eigen::Index column = 0; column <= row; ++column) {
        file >> problem.g(row, column);
        problem.g(column, row) = problem.g(row, column);
      }
    problems.push_back(problem);
  }
  return problems;
}

// 1e-9 of the largest velocity is good enough for the solver where 1e-12 is far off. Its impulses are put into the
// cones at the end, which changes velocities by at most |G| times the residual of the impulses: a factor of 6 rows'
// width.
TEST(ConeProblem, TheHardestOnesThatScenesPoseAreSolved) {
  const std::vector<PosedProblem> problems = posedProblems();
  ASSERT_EQ(problems.size(), 32U);
  for (const PosedProblem& problem : problems) {
    const ContactSolution solution = solveFrictionalContact(problem.g, problem.free, problem.frictions);
    const VectorX velocities = problem.g * solution.impulses + problem.free;
    const double fastest = problem.free.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < std::ssize(problem.frictions); ++i) {
      const double unit = std::sqrt(3 / problem.g.diagonal().segment<3>(3 * i).sum());
      const Vec3 z = solution.impulses.segment<3>(3 * i) / unit, u = unit * velocities.segment<3>(3 * i);
      const Vec3 off = coulombResidual(z, u, problem.frictions[static_cast<std::size_t>(i)]) / unit;
      EXPECT_LT(off.cwiseAbs().maxCoeff(), 6e-9 * fastest) << problem.name << " contact " << i;
    }
  }
}

/// The one A lambda + b >= 0 with lambda >= 0 and their product 0, by trying every set of rows that push.
VectorX complementaryByEnumeration(const MatrixX& a, const VectorX& b) {
  VectorX best;
  double leastViolation = INFINITY;
  for (int set = 0; set < 1 << b.size(); ++set) {
    std::vector<Eigen::Index> pushing;
    for (Eigen::Index row = 0; row < b.size(); ++row)
      if (set >> row & 1) pushing.push_back(row);
    VectorX lambda = VectorX::Zero(b.size());
    const MatrixX part = a(pushing, pushing);
    const VectorX pushes = -b(pushing);
    if (!pushing.empty()) lambda(pushing) = VectorX(part.completeOrthogonalDecomposition().solve(pushes));
    const VectorX left = a * lambda + b;
    const double violation =
        std::max({-lambda.minCoeff(), -left.minCoeff(), lambda.cwiseProduct(left).cwiseAbs().maxCoeff()});
    if (violation < leastViolation) leastViolation = violation, best = left;
  }
  return best;
}

// Without friction the normal parts are the linear complementarity problem's, whose A lambda + b is one only, also
// where A is singular.
TEST(ConeProblem, WithoutFrictionIsTheLinearComplementarityProblem) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    Rows rows = randomRows(6, 8, random);
    rows.frictions.assign(6, 0);
    const ContactSolution solution = rows.solve();
    const std::vector<int> normals = {2, 5, 8, 11, 14, 17};
    const MatrixX a = rows.matrix()(normals, normals);
    const VectorX left = complementaryByEnumeration(a, rows.free()(normals));
    EXPECT_LT((solution.velocities(normals) - left).norm(), 1e-10) << trial;
  }
}

// One contact pushes, the other, without friction, separates without sliding: no residual is left.
TEST(ConeProblem, WhatSeparatesStraightWithoutFrictionObeysCoulomb) {
  EXPECT_EQ(coulombResidual(Vec3::Zero(), Vec3(0, 0, 2), 0), Vec3(Vec3::Zero()));
  EXPECT_EQ(projectOnCone(Vec3(0, 0, -2), 0), Vec3(Vec3::Zero()));
  EXPECT_EQ(projectOnCone(Vec3(0, 3, 2), 0), Vec3(0, 0, 2));
}

// Heavy on light, four contacts each where three would do: each carries a quarter, to the rounding over 1e-9.
TEST(ConeProblem, WithoutFrictionRedundantContactsShareTheLoad) {
  for (const double top : {1.0, 1000.0}) {
    Rows stack = stackOf({1, 1, top}, 0);
    for (Eigen::Index body = 0; body < 3; ++body) stack.velocities[6 * body + 2] = -kGravity;
    const ContactSolution solution = stack.solve();
    EXPECT_TRUE(solution.converged);
    for (Eigen::Index i = 0; i < 12; ++i) {
      const double quarter = (top + static_cast<double>(2 - i / 4)) * kGravity / 4;
      EXPECT_NEAR(solution.impulses[3 * i + 2], quarter, 1e-6 * quarter) << i;
    }
  }
}

// Between two walls that close on it with 1 and 3 a ball cannot give way to both: it moves with their mean, and the
// impulses, which grow with every attempt, balance.
TEST(ConeProblem, WedgedWithoutFrictionIsLeftBetween) {
  Rows ball{MatrixX::Zero(6, 3), VectorX::Constant(3, 1.0), VectorX::Zero(3), {0, 0}};
  ball.j << 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0;
  VectorX free = VectorX::Zero(6);
  free[2] = -1, free[5] = -3;
  const ContactSolution solution = solveFrictionalContact(ball.matrix(), free, ball.frictions);
  EXPECT_FALSE(solution.converged);
  EXPECT_NEAR(solution.residual, 2, 1e-6) << solution.impulses << solution.velocities;
  EXPECT_LT((ball.velocitiesAfter(solution) - Vec3(-1, 0, 0)).norm(), 1e-6);
}

// A body on a ball joint, touched at r from it: nothing moves along r. Where that lies in the cone of friction, or its
// opposite does, whatever comes is stopped: pushes along r are free, and wedge it. Elsewhere Coulomb's law holds.
TEST(ConeProblem, OfOneContactOnABallJointSticksWhereTheArmLiesInTheCone) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> number(-1, 1);
  int wedged = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 arm(number(generator), number(generator), number(generator)),
        spin(number(generator), number(generator), number(generator));
    const double friction = 1.5 * std::abs(number(generator));
    const Mat3 inverseInertia = Vec3(1 + number(generator) / 2, 1 + number(generator) / 2, 1).asDiagonal();
    Mat3 lever;
    for (int axis = 0; axis < 3; ++axis) lever.col(axis) = arm.cross(Vec3::Unit(axis));
    const Mat3 matrix = lever.transpose() * inverseInertia * lever;
    const Vec3 free = spin.cross(arm);
    const ContactSolution solution = solveFrictionalContact(matrix, free, {friction});
    SCOPED_TRACE(::testing::Message() << arm.transpose() << " friction " << friction);
    const double beside = arm.head<2>().norm() / std::abs(arm.z());
    if (std::abs(beside - friction) < 0.01 * friction || arm.squaredNorm() < 0.01) continue;  // nearly singular
    expectCoulomb(solution, {friction}, 1e-8);
    if (beside > friction || free.z() >= 0) continue;
    EXPECT_LT(solution.velocities.norm(), 1e-12 * (1 + solution.impulses.norm()));
    ++wedged;
  }
  EXPECT_GT(wedged, 100);
}

// A body on a hinge moves along one direction w, W = w w^T; what ties leave of far larger numbers is noise of 1e-16 of
// these. A push along the normal stops it, whatever the friction.
TEST(ConeProblem, OfOneContactOnAHingeStopsItThroughTheNoiseOfTies) {
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    Vec3 along(number(generator), number(generator), 0.2 + std::abs(number(generator)));
    along *= 1e-2;  // of a lever far shorter than the body, whose untied inverse mass is about 1
    Mat3 noise = Mat3::NullaryExpr([&]() { return 1e-16 * number(generator); });
    const Mat3 matrix = along * along.transpose() + noise + noise.transpose();
    const Vec3 free = -along + Vec3(number(generator), number(generator), number(generator)) * 1e-14;
    const double friction = 3 * std::abs(number(generator));
    const ContactSolution solution = solveFrictionalContact(matrix, free, {friction});
    SCOPED_TRACE(::testing::Message() << along.transpose() << " friction " << friction);
    // z_n along.z() = 1 without friction; friction can make it more or less, and stops it all the same.
    EXPECT_LT(solution.velocities.norm(), 1e-9 * free.norm());
    EXPECT_LT(solution.impulses.norm(), 1e6);
  }
}

}  // namespace
}  // namespace cradle
