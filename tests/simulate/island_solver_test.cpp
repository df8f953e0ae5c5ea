#include "simulate/island_solver.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A scene and the solver of its first island.
struct Solved {
  explicit Solved(const std::string& members, double toleranceFactor = 1)
      : scene(sceneWith(members)), plan(planOf(scene)) {
    IslandPlan& island = plan.islands.at(0);
    island.method.keepsPromise = false;
    island.method.tolerance *= toleranceFactor;
    solver.emplace(scene, assemble(scene, island), island.method);
  }
  const VectorX& stateAt(double time) { return solver->stateAt(time); }

  Scene scene;
  Plan plan;
  std::optional<IslandSolver> solver;
};

/// A ball of 1 kg that swings on a spring along x with 20/s, and turns about an axis of its own.
std::string springScene(double accuracy) {
  return fmt::format(R"("duration": 1, "accuracy": {}, "gravity": [0, 0, 0], "bodies": [{{"name": "ball",
    "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [0.5, 0, 0], "angularVelocity": [1, -2, 3]}}],
    "springs": [{{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [-1, 0, 0], "stiffness": 400, "restLength": 1}}])",
                     accuracy);
}

const std::string kSolvedFloor =
    R"("materials": {"stuff": {"restitution": 0.5, "staticFriction": 0.3, "dynamicFriction": 0.2}},
    "bodies": [{"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "stuff"}, )";

std::string solvedBall(const std::string& name, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  return fmt::format(R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "material": "stuff",
    "position": {}, "linearVelocity": {}}})",
                     name, vectorText(position), vectorText(velocity));
}

// Frames lie inside steps: x = 0.5 cos(20 t) to the accuracy, position and velocity (20 times as large).
TEST(IslandSolver, InterpolatesToTheAccuracy) {
  for (const double accuracy : {1e-5, 1e-8}) {
    Solved at(springScene(accuracy));
    for (int i = 0; i <= 37; ++i) {
      const double time = i / 37.0;
      const VectorX& state = at.stateAt(time);
      EXPECT_NEAR(centerOfMass(state, 0).x(), 0.5 * std::cos(20 * time), accuracy) << time;
      EXPECT_NEAR(linearVelocity(state, 0).x(), -10 * std::sin(20 * time), 20 * accuracy) << time;
    }
  }
}

// No torque acts on a ball that its spring holds at its centre: its angle is t times its spin, however long a step is.
TEST(IslandSolver, TurnsBodiesWithoutTorqueByTheirSpin) {
  Solved at(springScene(1e-5));
  ASSERT_THAT(at.plan.islands[0].nonRotating, ElementsAre(0));
  for (const double time : {0.0, 0.123, 0.9}) {
    const Vec3 turn = time * Vec3(1, -2, 3);
    const Quat expected = time > 0 ? rotationAbout(turn.normalized(), turn.norm()) : Quat::Identity();
    EXPECT_LT(orientationError(orientation(at.stateAt(time), 0), expected), 1e-15) << time;
  }
}

// Steps do not know of frames: what is asked in between changes nothing, to the bit.
TEST(IslandSolver, TakesTheSameStepsForAllFrames) {
  Solved once(springScene(1e-6)), often(springScene(1e-6));
  for (int i = 0; i <= 100; ++i) often.stateAt(0.0077 * i);
  EXPECT_EQ(once.stateAt(0.777), often.stateAt(0.777));
}

// At the instant of an impact, as near as times are told apart, the state is the one after it.
TEST(IslandSolver, HasTheStateAfterAnEventAtItsInstant) {
  const double time = std::sqrt(2 * 1.25 / kGravity), speed = kGravity * time;
  const std::string scene = R"("duration": 1, )" + kSolvedFloor + solvedBall("ball", Vec3(0, 1.35, 0)) + "]";
  EXPECT_NEAR(linearVelocity(Solved(scene).stateAt(time - 1e-6), 0).y(), -speed, 2e-5);
  Solved at(scene);
  at.stateAt(time + 1e-6);
  const std::vector<Event> events = at.solver->takeEvents();
  ASSERT_FALSE(events.empty());
  Solved there(scene);
  EXPECT_NEAR(linearVelocity(there.stateAt(events[0].time), 0).y(), speed / 2, 1e-9);
  EXPECT_NEAR(linearVelocity(there.stateAt(time + 1e-6), 0).y(), speed / 2, 2e-5);
}

// Inside steps a box that slides stays on the floor, and a pendulum's rod as long as it is: to rounding.
TEST(IslandSolver, ProjectsFramesInsideSteps) {
  Solved box(R"("duration": 1, "accuracy": 1e-4, )" + kSolvedFloor +
             R"({"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 3, "material": "stuff",
             "position": [0, 0.1, 0], "linearVelocity": [0.6, 0, 0.8], "angularVelocity": [0, 2, 0]}])");
  Solved pendulum(R"("duration": 1, "accuracy": 1e-4, "bodies": [)" +
                  cradle::ball("ball", Vec3(0.6, -0.8, 0), Vec3(0, 0, 2)) +
                  R"(], "rods": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}])");
  for (int i = 1; i <= 30; ++i) {
    const VectorX slid = box.stateAt(0.01 * i);
    for (const double x : {-0.2, 0.2})
      for (const double z : {-0.3, 0.3})
        EXPECT_NEAR((Vec3(centerOfMass(slid, 0)) + orientation(slid, 0) * Vec3(x, -0.1, z)).y(), 0, 1e-14) << i;
    EXPECT_NEAR(centerOfMass(pendulum.stateAt(0.033 * i), 0).norm(), 1, 1e-14) << i;
  }
}

// A ball that rolls down another one stays a sum of radii, 0.6 m, away from its centre: the interpolant leaves that by
// the error of steps, 1e-6 m.
TEST(IslandSolver, ProjectsFramesOntoContactsWithWhatIsRound) {
  Solved at(R"("duration": 1, "accuracy": 1e-4, "materials": {"stuff": {"restitution": 0.5, "staticFriction": 0.3,
      "dynamicFriction": 0.2}}, "bodies": [{"name": "lower", "shape": {"sphere": {"radius": 0.5}}, "motion": "static",
      "material": "stuff"}, )" +
            solvedBall("upper", 0.6 * Vec3(std::sin(0.3), std::cos(0.3), 0)) + "]");
  for (int i = 1; i <= 30; ++i) EXPECT_NEAR(centerOfMass(at.stateAt(0.01 * i), 0).norm(), 0.6, 1e-14) << i;
}

// Steps of one length have the motion of contacts inside them as well: a box that slides with a = -mu g neither sinks
// nor hovers there. Impulses are found to 1e-7 of g h.
TEST(IslandSolver, ShowsContactInsideStepsOfOneLength) {
  constexpr double kStep = 0.01;
  Solved at(R"("duration": 1, "method": {"name": "rk4", "timeStep": 0.01}, )" + kSolvedFloor +
            R"({"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 3, "material": "stuff",
            "position": [0, 0.1, 0], "linearVelocity": [0.6, 0, 0]}])");
  for (const double time : {0.003, 0.013, 0.017}) {
    const VectorX& state = at.stateAt(time);
    EXPECT_NEAR(centerOfMass(state, 0).y(), 0.1, 1e-7 * kGravity * kStep * kStep) << time;
    EXPECT_NEAR(centerOfMass(state, 0).x(), 0.6 * time - 0.1 * kGravity * time * time, 1e-7 * kGravity * kStep * kStep);
    EXPECT_NEAR(linearVelocity(state, 0).y(), 0, 1e-7 * kGravity * kStep) << time;
  }
}

/// Balls, each of which flies to and fro between walls with 1e5 impacts a second, with a size of 0.1 m and gravity
/// along the walls.
std::string tooManyImpacts(double accuracy, int balls) {
  std::string bodies;
  for (int i = 0; i < balls; ++i)
    bodies += ", " + solvedBall(fmt::format("b{}", i), Vec3(0, 0.1 + 1e-5, i), Vec3(0, 2, 0));
  std::string links;
  for (int i = 1; i < balls; ++i)
    links += fmt::format(R"({}{{"bodyA": "b0", "bodyB": "b{}", "stiffness": 1e-9, "restLength": {}}})",
                         i > 1 ? ", " : "", i, i);
  return fmt::format(
      R"("duration": 1, "accuracy": {}, "gravity": [2.4525, 0, 0], "materials": {{"stuff": {{
    "restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [{{"name": "floor",
    "shape": {{"plane": {{}}}}, "motion": "static", "material": "stuff"}}, {{"name": "wall", "shape": {{"plane": {{
    "normal": [0, -1, 0]}}}}, "motion": "static", "position": [0, {}, 0], "material": "stuff"}}{}], "springs": [{}])",
      accuracy, 0.2 + 2e-5, bodies,
      balls > 1 ? links : R"({"bodyA": "b0", "anchorB": [0, 0, 0], "stiffness": 1e-9, "restLength": 0})");
}

// 501 events in 1/60 s end the promise at the last of them. Steps of contact are 1/300 of sqrt(size / g) for up to four
// bodies, 1/960 s at most; at visual accuracies, and for more bodies, they are 1/960 s.
TEST(IslandSolver, GivesThePromiseUpWhereEventsAreTooMany) {
  struct Case {
    double accuracy;
    int balls;
    std::string steps;
  };
  const std::string shortSteps = fmt::format("every {:.3g} s as long as that lasts", std::sqrt(0.1 / 2.4525) / 300);
  for (const Case& tried : {Case{1e-6, 1, shortSteps}, Case{1e-6, 5, "every 0.00104 s as long as that lasts"},
                            Case{1e-3, 1, "every 0.00104 s to the end"}}) {
    Solved at(tooManyImpacts(tried.accuracy, tried.balls));
    EXPECT_FALSE(at.solver->promiseEnd());
    at.stateAt(0.006);
    const std::optional<PromiseEnd>& end = at.solver->promiseEnd();
    ASSERT_TRUE(end) << tried.steps;
    if (tried.balls == 1) {
      EXPECT_NEAR(end->time, ((tried.accuracy < 1e-4 ? 501 : 61) - 0.5) / 1e5, 1e-9);
    }
    EXPECT_THAT(end->reason, HasSubstr("contacts change more than"));
    EXPECT_THAT(end->warning, AllOf(HasSubstr("experiment.json"), HasSubstr(end->reason), HasSubstr(tried.steps)));
  }
}

// Errors a million times as large as the accuracy asks take energy: beyond ten times the accuracy, all bodies' promise
// ends. With the plan's own tolerance, it is kept.
TEST(IslandSolver, EndsThePromiseWhereEnergyShowsErrors) {
  for (const double factor : {1.0, 1e6}) {
    Solved at(springScene(1e-8), factor);
    for (int i = 0; i <= 20; ++i) at.stateAt(i / 20.0);
    EXPECT_FALSE(at.solver->promiseEnd());
    at.solver->finish();
    ASSERT_EQ(at.solver->promiseEnd().has_value(), factor > 1);
    if (factor == 1) continue;
    EXPECT_THAT(at.solver->promiseEnd()->reason, HasSubstr("numerical energy is beyond 10 times the accuracy"));
    EXPECT_THAT(at.solver->promiseEnd()->bodies, ElementsAre(0));
    EXPECT_THAT(at.solver->promiseEnd()->warning, HasSubstr("was not kept from"));
  }
}

// A frame inside a step has an error of its own, which is booked for that frame: the next ones do not inherit it.
TEST(IslandSolver, BooksTheEnergyOfFramesInsideSteps) {
  Solved at(springScene(1e-3));
  for (int i = 0; i <= 37; ++i) {
    const VectorX& state = at.stateAt(i / 37.0);
    const double x = centerOfMass(state, 0).x(), speed = linearVelocity(state, 0).x();
    // Kinetic energy and that of the spring, and 2/5 m r^2 w^2 / 2 of the spin.
    const double energy = speed * speed / 2 + 200 * x * x + 0.002 * 14;
    EXPECT_NEAR(energy + numericalEnergy(state), 50 + 0.002 * 14, 1e-12) << i;
  }
}

}  // namespace
}  // namespace cradle
