// A disk that rolls on its rim about a centre of mass at rest (Euler's disk, without any loss), on and beside its
// steady motion. With tilt a of the axis from the vertical, rim in direction e_r and face below in direction -e_a of
// the axis, radius r and half thickness c, the point of contact is at P = r e_r - c e_a from the centre. That and the
// centre are at rest, so the angular velocity is along P; the axis goes about the vertical with W:
//   w = -W sin(a) (e_r - (c / r) e_a).
// The floor carries m g; the rate W z x L of the angular momentum equals the torque P x m g z:
//   W^2 sin(a) (I_t cos(a) - I_a (c / r) sin(a)) = m g (r cos(a) - c sin(a)),
// with I_t = m (r^2 / 4 + c^2 / 3) across the axis and I_a = m r^2 / 2 along it. Thin: W^2 sin(a) = 4 g / r
// (H. K. Moffatt, "Euler's disk and its finite-time singularity", Nature 404, 2000).

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/experiment.h"
#include "math/rotation.h"

namespace cradle {
namespace {

struct RollingDisk {
  double radius = 0.0375, halfThickness = 0.0005;  // m
  double tilt = 0.3;                               // rad
  double friction = 0.5;

  double precession() const {
    const double r = radius, c = halfThickness, a = tilt;
    const double across = r * r / 4 + c * c / 3, along = r * r / 2;
    return std::sqrt(kGravity * (r * std::cos(a) - c * std::sin(a)) /
                     (std::sin(a) * (across * std::cos(a) - along * c / r * std::sin(a))));
  }
  double height() const { return radius * std::sin(tilt) + halfThickness * std::cos(tilt); }

  /// For `duration`; 1 + `excess` times as fast as it should be.
  Trajectory run(double duration, double accuracy, double excess = 0) const {
    const Vec3 axis(std::sin(tilt), std::cos(tilt), 0), down(std::cos(tilt), -std::sin(tilt), 0);
    const Vec3 spin = -(1 + excess) * precession() * std::sin(tilt) * (down - halfThickness / radius * axis);
    const Quat turn = rotationAbout(Vec3::UnitZ(), -tilt);  // +y to the axis
    return simulate(sceneWith(fmt::format(
        R"("duration": {}, "accuracy": {}, "output": {{"framesPerSecond": 200}},
        "materials": {{"m": {{"restitution": 0, "staticFriction": {}, "dynamicFriction": {}}}}},
        "bodies": [{{"name": "floor", "material": "m", "shape": {{"plane": {{}}}}, "motion": "static"}},
          {{"name": "disk", "material": "m", "mass": 0.4, "shape": {{"cylinder": {{"radius": {}, "length": {}}}}},
            "position": {}, "orientation": {{"w": {}, "x": {}, "y": {}, "z": {}}}, "angularVelocity": {}}}])",
        duration, accuracy, friction, friction, radius, 2 * halfThickness, vectorText(Vec3(0, height(), 0)), turn.w(),
        turn.x(), turn.y(), turn.z(), vectorText(spin))));
  }
};

class EulersDisk : public testing::TestWithParam<double> {};

// The steady motion of a disk on its rim is stable for tilts as small as these: errors of the steps, 1e-8 of sizes and
// speeds of 1, grow no faster than time.
TEST_P(EulersDisk, PrecessesAtTheSpeedOfTheClosedForm) {
  for (const double friction : {0.5, 0.0}) {
    const RollingDisk disk{.tilt = GetParam(), .friction = friction};
    const double duration = 0.5, accuracy = 1e-8, tolerance = 1e-5;
    for (const Frame& frame : disk.run(duration, accuracy).frames) {
      const BodyState& state = frame.states[0];
      const Vec3 axis = state.orientation * Vec3::UnitY();
      // Counter-clockwise seen from above: about +y, from +x towards -z.
      const double heading = disk.precession() * frame.time;
      const Vec3 expected(std::sin(disk.tilt) * std::cos(heading), std::cos(disk.tilt),
                          -std::sin(disk.tilt) * std::sin(heading));
      ASSERT_LT((axis - expected).norm(), tolerance) << "at " << frame.time << " s, friction " << friction;
      ASSERT_LT((state.position - Vec3(0, disk.height(), 0)).norm(), tolerance * disk.radius);
    }
  }
}

// Started beside its steady motion it nods, slips perhaps for a moment, but nothing takes its energy while it rolls,
// and it never rests: it has nothing to rest on.
TEST_P(EulersDisk, NeverRests) {
  for (const double excess : {0.0, 0.02, -0.02}) {
    const RollingDisk disk{.tilt = GetParam(), .friction = 1.0};
    const Trajectory run = disk.run(1, 1e-6, excess);
    EXPECT_TRUE(eventsOf(run, EventKind::rest).empty()) << "excess " << excess;
    EXPECT_GT(run.frames.back().energy.kinetic, 0.9 * run.frames.front().energy.kinetic) << "excess " << excess;
    for (const Frame& frame : run.frames)
      ASSERT_NEAR(mechanicalEnergy(frame), mechanicalEnergy(run.frames[0]), 1e-4 * run.frames[0].energy.kinetic)
          << "at " << frame.time << " s, excess " << excess;
  }
}

// Where a look is enough, it does not rest either, and loses no more than errors of some thousand steps.
TEST_P(EulersDisk, NeverRestsWhereALookIsEnough) {
  const RollingDisk disk{.tilt = GetParam(), .friction = 1.0};
  const Trajectory run = disk.run(2, 1e-3);
  EXPECT_TRUE(eventsOf(run, EventKind::rest).empty());
  EXPECT_NEAR(mechanicalEnergy(run.frames.back()), mechanicalEnergy(run.frames.front()),
              0.1 * run.frames.front().energy.kinetic);
}

INSTANTIATE_TEST_SUITE_P(Tilts, EulersDisk, testing::Values(0.03, 0.1, 0.3),
                         [](const auto& info) { return "Index" + std::to_string(info.index); });

}  // namespace
}  // namespace cradle
