#include "collision/pair_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/random_poses.h"
#include "constraints/equations_of_motion.h"
#include "dynamics/integrators/rk4.h"
#include "mesh/primitives.h"

namespace cradle {
namespace {

constexpr double kPull = 9.81;       // m/s^2
constexpr double kTouching = 1e-11;  // m

/// Two free bodies, or one over a plane, in a step of theirs.
struct SearchedPair {
  Mechanism mechanism;
  ContactGeometry geometry;
  VectorX start;
  Step step;

  SearchedPair(Collider a, Collider b) : SearchedPair(2) {
    a.body = 0, b.body = 1;
    geometry.colliders = {std::move(a), std::move(b)};
    geometry.pairs = {{0, 1, false, {}}};
  }
  explicit SearchedPair(Collider a) : SearchedPair(1) {
    a.body = 0;
    geometry.colliders = {std::move(a)};
    geometry.planes = {{Vec3::Zero(), Vec3::UnitY()}};
    geometry.pairs = {{0, 0, true, {}}};
  }
  void place(int body, const RigidTransform& pose, const Vec3& velocity = Vec3::Zero(),
             const Vec3& spin = Vec3::Zero()) {
    centerOfMass(start, body) = pose.translation;
    setOrientation(start, body, pose.rotation);
    linearVelocity(start, body) = velocity, angularVelocity(start, body) = spin;
  }
  void take(double timeStep) {
    EquationsOfMotion equations(mechanism);
    const RightHandSide rightHandSide = equations.rightHandSide();
    rk4(rightHandSide, start, 0, timeStep, step);
    prepareInterpolant(rightHandSide, step);
  }
  std::optional<ImpactTime> first(const TouchingFeatures& touching = {kTouching}) const {
    return ImpactSearch(geometry).first(step, touching);
  }

 private:
  explicit SearchedPair(int bodies) : start(VectorX::Zero(stateSize(bodies))) {
    for (int i = 0; i < bodies; ++i) {
      mechanism.bodies.push_back(makeRigidBody({1, Vec3::Zero(), Vec3(0.02, 0.05, 0.06).asDiagonal()}));
      setOrientation(start, i, Quat::Identity());
    }
  }
};

const Collider kBrick = colliderOf(Box{Vec3(0.4, 0.2, 0.6)}, {});

// A ball that touches a turning face and leaves it with a speed u is caught by it again. With the face at h from the
// axis, the ball's radius r and its place d beside the axis, the gap is
//   g(t) = (h + r + (w d + u) t) cos(w t) - d sin(w t) - (h + r),
// which bends down by w^2 (h + r): more than any point of the small brick is accelerated, by w^2 times its reach.
TEST(PairSearch, FindsTheTurningFaceThatCatchesABall) {
  const double radius = 1, height = 0.1 + radius, aside = 0.02;
  for (const bool ballFirst : {false, true})
    for (const double spin : {1.0, 2.0})
      for (const double part : {0.3, 0.6, 0.9}) {  // of the step, about that of the catch
        const double timeStep = 0.16 / spin;       // s: the ball is above the face until its end
        const double leaving = part * timeStep / 2 * spin * spin * height;
        const auto gap = [&](double t) {
          return (height + (spin * aside + leaving) * t) * std::cos(spin * t) - aside * std::sin(spin * t) - height;
        };
        double before = 0.5 * part * timeStep, after = 2 * timeStep;
        for (int i = 0; i < 60; ++i) (gap((before + after) / 2) > 0 ? before : after) = (before + after) / 2;
        SearchedPair pair(ballFirst ? colliderOf(Sphere{radius}, {}) : kBrick,
                          ballFirst ? kBrick : colliderOf(Sphere{radius}, {}));
        pair.place(ballFirst ? 1 : 0, {Quat::Identity(), Vec3::Zero()}, Vec3::Zero(), spin * Vec3::UnitZ());
        pair.place(ballFirst ? 0 : 1, {Quat::Identity(), Vec3(aside, height, 0)}, Vec3(0, spin * aside + leaving, 0));
        pair.take(timeStep);
        const auto found = pair.first({kTouching, 0.1 * kTouching});
        ASSERT_TRUE(found) << spin << " " << part;
        EXPECT_NEAR(found->fraction * timeStep, before, 1e-4) << spin << " " << part;  // one step of RK4
      }
}

// Bricks, capsules, cylinders and spheres that fly by each other and spin: the oracle looks at the gap at 500 instants
// of the step's interpolant. What is found lies between the last one without overlap and the first with one, and
// nothing is found where there is none. (Touches shorter than a 500th are the search's alone: then the gap there is 0.)
TEST(PairSearch, FindsTheFirstTouchThatAFineSamplingSees) {
  const std::vector<Collider> shapes = {kBrick, colliderOf(Capsule{0.08, 0.4}, {}), colliderOf(Cylinder{0.1, 0.3}, {}),
                                        colliderOf(Sphere{0.15}, {})};
  constexpr int kSamples = 500;
  RandomPoses random(8);
  int hits = 0, misses = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (std::size_t k = i; k < shapes.size(); ++k)
      for (int trial = 0; trial < 5; ++trial) {
        SearchedPair pair(shapes[i], shapes[k]);
        const Vec3 aside = random.vector(0.4), spinA = random.vector(4), spinB = random.vector(4);
        const Quat turnA = random.turn(), turnB = random.turn();
        pair.place(0, {turnA, Vec3(-0.8, 0, 0)}, Vec3(8, 0, 0), spinA);
        pair.place(1, {turnB, Vec3(0.8, aside.y(), aside.z())}, Vec3(-7, 0, 0), spinB);
        pair.take(0.15);
        const auto gapAt = [&](double fraction) {
          return separation(pair.geometry, pair.geometry.pairs[0], 0, poseAt(pair.step, 0, fraction),
                            poseAt(pair.step, 1, fraction));
        };
        int sample = 0;
        while (sample <= kSamples && gapAt(static_cast<double>(sample) / kSamples) > 0) ++sample;
        const auto found = pair.first();
        SCOPED_TRACE(testing::Message() << i << " " << k << " " << trial);
        sample <= kSamples ? ++hits : ++misses;
        if (sample > kSamples && !found) continue;
        ASSERT_TRUE(found);
        EXPECT_NEAR(gapAt(found->fraction), 0, 1e-9);  // 1e-12 of the step at 15 m/s, and the roots of EPA
        if (sample > kSamples) continue;
        EXPECT_LE(found->fraction, static_cast<double>(sample) / kSamples + 1e-12);
        EXPECT_GT(found->fraction, static_cast<double>(sample - 1) / kSamples);
      }
  EXPECT_GT(hits, 15);
  EXPECT_GT(misses, 5);
}

// Two bricks whose edges cross at right angles: one lies on its edge along z, the other hangs from above with an edge
// along x. Each edge is at half the diagonal of its cross-section from the centre.
TEST(PairSearch, FindsWhereCrossingEdgesMeet) {
  SearchedPair pair(kBrick, kBrick);
  const double lower = std::hypot(0.2, 0.1), upper = std::hypot(0.1, 0.3);
  pair.place(0, {rotationAbout(Vec3::UnitZ(), std::atan2(0.2, 0.1)), Vec3::Zero()});
  pair.place(1, {rotationAbout(Vec3::UnitX(), -std::atan2(0.3, 0.1)), Vec3(0.01, lower + upper + 0.05, 0.02)},
             Vec3(0, -2, 0));
  pair.take(0.1);
  const auto found = pair.first();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->fraction, 0.05 / 2 / 0.1, 1e-11);  // of heights of 0.6 m, at 2 m/s
}

// A brick that falls on one corner over a large box: its height follows from the turn, and the corner is named.
TEST(PairSearch, FindsWhichCornerComesToAFace) {
  SearchedPair pair(kBrick, colliderOf(Box{Vec3(4, 1, 4)}, {}));
  const Quat turn = rotationAbout(Vec3(1, 2, 3), 0.9);
  std::size_t corner = 0;
  for (std::size_t i = 0; i < 8; ++i)
    if ((turn * kBrick.points[i]).y() < (turn * kBrick.points[corner]).y()) corner = i;
  pair.place(0, {turn, Vec3(0.2, 0.5 - (turn * kBrick.points[corner]).y() + 0.03, 0)}, Vec3(0, -1, 0));
  pair.place(1, {Quat::Identity(), Vec3::Zero()});
  pair.mechanism.gravity = Vec3(0, -kPull, 0);
  pair.take(0.05);  // both fall alike
  const auto found = pair.first();
  ASSERT_TRUE(found);
  ASSERT_TRUE(found->face);
  EXPECT_EQ(found->feature, corner);
  EXPECT_NEAR(found->fraction, 0.03 / 1 / 0.05, 2e-12);
}

// What leaves the floor comes back after 2 v / g, and is an impact again then.
TEST(PairSearch, FindsTheReturnOfWhatLeaves) {
  for (const double speed : {0.5, 1e-3}) {
    SearchedPair pair(colliderOf(Sphere{0.1}, {}));
    pair.mechanism.gravity = Vec3(0, -kPull, 0);
    pair.place(0, {Quat::Identity(), Vec3(0, 0.1, 0)}, Vec3(0, speed, 0));
    pair.take(0.15);
    const auto found = pair.first({kTouching, 1e-12});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->fraction * 0.15, 2 * speed / kPull, 2e-13 + 4e-17 / speed);  // heights are rounded to 1e-17 m
    EXPECT_FALSE(pair.first({kTouching}));  // without a dead band it is passed over
  }
}

// What touches without a load sinks in by the dead band until it counts: g t^2 / 2.
TEST(PairSearch, LetsWhatTouchesSinkByTheDeadBand) {
  for (const double band : {1e-4, 1e-8}) {
    SearchedPair pair(colliderOf(Sphere{0.1}, {}));
    pair.mechanism.gravity = Vec3(0, -kPull, 0);
    pair.place(0, {Quat::Identity(), Vec3(0, 0.1, 0)});
    pair.take(0.01);
    const auto found = pair.first({kTouching, band});
    ASSERT_TRUE(found);
    const double time = std::sqrt(2 * band / kPull);
    EXPECT_NEAR(found->threshold, -band, 1e-17);
    EXPECT_NEAR(found->fraction * 0.01, time, 2e-14 + 2e-17 / (kPull * time));
  }
}

/// A brick on the floor, of which the corners with these numbers are held.
std::vector<ActiveFeature> heldCorners(const std::vector<std::size_t>& corners) {
  std::vector<ActiveFeature> held;
  for (const std::size_t corner : corners) {
    ContactConstraint contact;
    contact.centerA = {0, kBrick.points[corner]};
    held.push_back({0, corner, contact});
  }
  return held;
}

// Turned about the corners at x = -0.2, the brick comes down with the others at the angle of their start: w t = 0.01.
// If these are held instead, or three corners, nothing else comes down.
TEST(PairSearch, SearchesTheCornersThatAreNotHeld) {
  SearchedPair pair(kBrick);
  const Quat tilt = rotationAbout(Vec3::UnitZ(), 0.01);
  const Vec3 arm = tilt * Vec3(0.2, 0.1, 0), spin(0, 0, -1);
  pair.place(0, {tilt, arm}, spin.cross(arm), spin);
  pair.take(0.02);
  std::vector<std::size_t> left, right;
  for (std::size_t i = 0; i < 8; ++i)
    if (kBrick.points[i].y() < 0) (kBrick.points[i].x() < 0 ? left : right).push_back(i);
  std::vector<ActiveFeature> held = heldCorners(left);
  const auto found = pair.first({kTouching, 1e-12, &held});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->feature == right[0] || found->feature == right[1]);
  // The held edge is not: it goes straight on while the body turns, by (w t)^2 / 2 of 0.2 m in the height.
  EXPECT_NEAR(found->fraction, 0.5, 0.01);
  held = heldCorners({left[0], left[1], right[0]});
  EXPECT_FALSE(pair.first({kTouching, 1e-12, &held}));
}

TEST(PairSearch, KeepsTheEarlierOfTwo) {
  SearchedPair pair(kBrick, kBrick);
  pair.place(1, {Quat::Identity(), Vec3(0, 0.3, 0)}, Vec3(0, -1, 0));
  pair.take(0.2);
  ImpactSearch search(pair.geometry);
  for (const double known : {0.49, 0.51}) {  // the bricks meet after 0.1 s
    std::optional<ImpactTime> best{std::in_place};
    best->fraction = known, best->pair = 7;
    search.first(pair.step, {kTouching});  // which prepares it for this step
    PairSearch(search, pair.step, 0).search({kTouching}, best);
    ASSERT_TRUE(best);
    EXPECT_NEAR(best->fraction, known < 0.5 ? known : 0.5, 2e-12);
    EXPECT_EQ(best->pair, known < 0.5 ? 7u : 0u);
  }
}

// Of a sphere around a corner of A over a face of B, and the other way round; both bodies are turned.
TEST(HeightOfCorner, IsThatOverThePlaneOfTheFace) {
  RandomPoses random(3);
  const Collider capsule = colliderOf(Capsule{0.08, 0.4}, {});
  for (const bool isFaceOfA : {false, true}) {
    const FaceBelow face{isFaceOfA, Vec3(0.6, 0, 0.8), Vec3(0.1, 0.2, 0.3)};
    const RigidTransform lower = random.pose(1), upper = random.pose(1);
    const std::pair<const Collider&, RigidTransform> below{kBrick, lower}, above{capsule, upper};
    const double height = isFaceOfA ? heightOfCorner(face, 1, below, above) : heightOfCorner(face, 1, above, below);
    const Vec3 center = upper * capsule.points[1];
    EXPECT_NEAR(height, (lower.rotation * face.normal).dot(center - lower * face.point) - 0.08, 1e-15);
  }
}

}  // namespace
}  // namespace cradle
