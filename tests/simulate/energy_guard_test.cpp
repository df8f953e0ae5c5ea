#include "simulate/energy_guard.h"

#include <gmock/gmock.h>

#include "constraints/spring_modes.h"
#include "core/error.h"
#include "experiments/experiment.h"
#include "simulate/steps/step_limit.h"

namespace cradle {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

struct Outcome {
  std::vector<std::string> warnings;
  std::string failure;  // empty: ran to its end
};

Outcome outcomeOf(const Scene& scene) {
  Outcome outcome;
  try {
    simulate(scene, {[](const Frame&) {}, [](const Event&) {},
                     [&](const std::string& warning) { outcome.warnings.push_back(warning); }});
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::unstable);
    outcome.failure = error.what();
  }
  return outcome;
}

Scene sceneMovedBy(const std::string& method, double duration, const std::string& rest) {
  return sceneOf(
      fmt::format(R"({{"schema": "cradle-scene/1", "name": "t", "duration": {}, {}, {}}})", duration, method, rest));
}

/// A ball of 2 kg on a spring of 0.9 m, stretched by 0.1 m.
Scene hungBall(const std::string& method, double timeStep, double stiffness, double damping) {
  return sceneMovedBy(methodText(method, timeStep), 600 * timeStep,
                      fmt::format(R"(
    "bodies": [{{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2, "position": [0, -1, 0]}}],
    "springs": [{{"name": "s", "bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "stiffness": {},
                  "damping": {}, "restLength": 0.9}}])",
                                  stiffness, damping));
}

/// 1 % on either side of a limit: a run to its end below, if not with all of its energy, warning and stop above.
void expectLimit(const std::string& method, double timeStep, double stiffness, double damping) {
  SCOPED_TRACE(method);
  const Outcome below = outcomeOf(hungBall(method, 0.99 * timeStep, stiffness, damping));
  EXPECT_THAT(below.warnings, Each(AnyOf(HasSubstr("of its energy in a period"), HasSubstr("the steps of"))));
  EXPECT_EQ(below.failure, "");
  const Outcome above = outcomeOf(hungBall(method, 1.01 * timeStep, stiffness, damping));
  EXPECT_THAT(above.warnings, ElementsAre(AllOf(HasSubstr("spring \"s\" has step x"), HasSubstr("is safe"))));
  EXPECT_THAT(above.failure, AllOf(HasSubstr("\"ball\""), HasSubstr("spring \"s\" has step x")));
}

// omega = sqrt(20000 / 2) = 100 rad/s. Where the stability functions reach modulus 1 on the imaginary axis: 2 (the
// matrix of the symplectic step has trace 2 - (h omega)^2), 2 sqrt(2) (1 - y^6/72 + y^8/576 = 1); DOP853's from its
// table.
TEST(Guard, StopsUndampedSpringsBeyondTheLimitOfEachMethod) {
  expectLimit("semiImplicitEuler", 2 / 100.0, 20000, 0);
  expectLimit("rk4", 2 * std::sqrt(2.0) / 100, 20000, 0);
  expectLimit("dop853", 5.9597 / 100, 20000, 0);
}

// damping / mass = 100 /s and next to no stiffness. On the real axis: 1 - z = -1 at 2 for both Euler methods; RK4:
// 1 - z + z^2/2 - z^3/6 + z^4/24 = 1 at z = 2.7853; DOP853's from its table.
TEST(Guard, StopsStrongDampersBeyondTheLimitOfEachMethod) {
  expectLimit("explicitEuler", 2 / 100.0, 1e-6, 200);
  expectLimit("semiImplicitEuler", 2 / 100.0, 1e-6, 200);
  expectLimit("rk4", 2.78529 / 100, 1e-6, 200);
  expectLimit("dop853", 6.3935 / 100, 1e-6, 200);
}

// Both at once, symplectic Euler: x'' + gamma x' + omega^2 x = 0 becomes unstable at h^2 omega^2 + 2 h gamma = 4. With
// omega = 100, gamma = 50: h = (-100 + sqrt(100^2 + 4 * 100^2 * 4)) / (2 * 100^2) = (sqrt(17) - 1) / 200.
// The weakly damped limit of explicit Euler, h = gamma / omega^2, is 0.005.
TEST(Guard, KnowsThatDampingMovesTheLimit) {
  expectLimit("semiImplicitEuler", (std::sqrt(17.0) - 1) / 200, 20000, 100);
  expectLimit("explicitEuler", 0.005, 20000, 100);
}

// Energy grows by 1 + (h omega)^2 a step. 600 steps of h omega = 0.001: 0.06 %; of 0.01: 6.2 %, and 6.5 % in a period,
// 2 pi / (h omega) steps; of 0.05: 4.47 times.
TEST(Guard, WarnsOfExplicitEulersGainIfItCanBeSeen) {
  EXPECT_THAT(outcomeOf(hungBall("explicitEuler", 1e-5, 20000, 0)).warnings, IsEmpty());
  EXPECT_THAT(outcomeOf(hungBall("explicitEuler", 1e-4, 20000, 0)).warnings,
              ElementsAre(HasSubstr("gains 6.5 % of its energy in a period")));
  EXPECT_THAT(outcomeOf(hungBall("explicitEuler", 5e-4, 20000, 0)).warnings,
              ElementsAre(AllOf(HasSubstr("gains energy at any step"), HasSubstr("4.47 times"))));
}

// Four springs at the corners of a plate of side a: omega^2 = 4 k / m up and down, 4 k (a/2)^2 / (m a^2 / 12) =
// 12 k / m about either axis of the plate, though each spring alone sees k (1 + 3 + 3) / m = 7 k / m.
TEST(SpringModes, AreThoseOfAllSpringsTogether) {
  std::string springs;
  for (const char* corner : {"0.5, 0, 0.5", "-0.5, 0, 0.5", "0.5, 0, -0.5", "-0.5, 0, -0.5"})
    springs += fmt::format(
        R"({}{{"bodyA": "plate", "anchorA": [{}], "anchorB": [{}], "stiffness": 100, "damping": 3, "restLength": 0.1}})",
        springs.empty() ? "" : ", ", corner, std::string(corner).replace(std::string(corner).find(", 0,") + 2, 1, "1"));
  const Scene scene = sceneMovedBy(methodText("rk4", 0.001), 1,
                                   R"("bodies": [{"name": "plate", "shape": {"box": {"size": [1, 1, 1]}}, "mass": 2,
      "centerOfMass": [0, 0, 0], "inertiaTensor": [[0.166666666666666667, 0, 0], [0, 0.3, 0], [0, 0, 0.166666666666666667]]}],
    "springs": [)" + springs + "]");
  const Assembly assembly = assemble(scene, planOf(scene).islands.at(0));
  EXPECT_NEAR(stiffestMode(assembly.mechanism, assembly.state).stiffness, 12 * 100 / 2.0, 1e-3);
  EXPECT_NEAR(mostDampedMode(assembly.mechanism, assembly.state).damping, 12 * 3 / 2.0, 1e-4);
}

// Two rods leave a ball the x axis alone, at 30 degrees to the spring: cos(30 degrees)^2 = 3/4 of its stiffness.
TEST(SpringModes, KnowWhatRodsLeave) {
  const Scene scene = sceneMovedBy(methodText("rk4", 0.001), 1, R"(
    "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 2}],
    "rods": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0]},
             {"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 1]}],
    "springs": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0.86602540378443865, 0.5, 0], "stiffness": 100}])");
  const Assembly assembly = assemble(scene, planOf(scene).islands.at(0));
  EXPECT_NEAR(stiffestMode(assembly.mechanism, assembly.state).stiffness, 0.75 * 100 / 2, 1e-9);
}

// A body in its place, on a spring of its rest length to the last bit or nearly so: what rounding makes of that length
// is no energy, however stiff the spring is.
TEST(Guard, AllowsTheRoundingOfStiffSpringsAtRest) {
  const Vec3 position(-0.6263, 0.7142, -1.0789), anchor(0.3096, 0.4957, 0.3574);
  const Vec3 held = position + Vec3(anchor.x(), -anchor.z(), anchor.y());
  for (const double stiffness : {1e3, 1e6, 1e9})
    for (int direction = 0; direction < 20; ++direction) {
      const double angle = 0.3 * direction, length = 0.3 + 0.07 * direction;
      const Scene scene = sceneWith(fmt::format(
          R"("duration": 0.05, "gravity": [0, 0, 0], "bodies": [{{"name": "b", "mass": 800,
          "shape": {{"cylinder": {{"radius": 0.5, "length": 1}}}}, "position": {},
          "orientation": {{"axis": [1, 0, 0], "angleDegrees": 90}}}}], "springs": [{{"bodyA": "b", "anchorA": {},
          "anchorB": {}, "stiffness": {}, "restLength": {}}}])",
          vectorText(position), vectorText(anchor),
          vectorText(held + length * Vec3(0.6 * std::cos(angle), std::sin(angle), 0.8 * std::cos(angle))), stiffness,
          length));
      EXPECT_EQ(outcomeOf(scene).failure, "") << stiffness << " " << direction;
    }
}

TEST(Guard, NamesARodThatTurnsTooFarInAStep) {
  for (const char* method : {"explicitEuler", "rk4", "dop853"}) {
    const Outcome outcome = outcomeOf(sceneMovedBy(methodText(method, 0.5), 100, R"(
      "bodies": [{"name": "bob", "shape": {"sphere": {"radius": 0.01}}, "mass": 1, "position": [-1, 0, 0],
                  "linearVelocity": [0, -5, 0]}],
      "rods": [{"name": "bar", "bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}])"));
    EXPECT_THAT(outcome.failure, AllOf(HasSubstr("unstable at"), HasSubstr("rod \"bar\" turns by"),
                                       HasSubstr("in a step of 0.5 s"), HasSubstr("rk4 with a timeStep of")))
        << method;
  }
}

TEST(Guard, BlamesAPushOfWhatNothingElseCouldDo) {
  // Whoever stands in the list first, and whatever the others are tied by.
  for (const char* pushed : {"a", "b", "c"})
    for (const char* direction : {"0, 1e20, 0", "1e20, 0, 0", "0, 0, 1e20"})
      for (const char* ties : {"rods", "ballJoints"}) {
        const bool isRod = std::string(ties) == "rods";
        const Outcome outcome = outcomeOf(sceneWith(fmt::format(
            R"("duration": 2, "bodies": [
              {{"name": "a", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [0, 1, 0]}},
              {{"name": "b", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [1, 1, 0]}},
              {{"name": "c", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [2, 1, 0]}}],
            "{}": [{{"bodyA": "a", "bodyB": "b", "anchorA": [{}, 0, 0], "anchorB": [{}, 0, 0]}},
                   {{"bodyA": "b", "bodyB": "c", "anchorA": [{}, 0, 0], "anchorB": [{}, 0, 0]}}],
            "pushes": [{{"body": "{}", "point": [0, 0, 0.05], "force": [{}], "start": 0.1, "duration": 0.02}}])",
            ties, isRod ? 0 : 0.5, isRod ? 0 : -0.5, isRod ? 0 : 0.5, isRod ? 0 : -0.5, pushed, direction)));
        EXPECT_THAT(outcome.failure, AllOf(HasSubstr(fmt::format("body \"{}\"", pushed)),
                                           HasSubstr("a push of 1e+20 N"), HasSubstr("less force")))
            << pushed << direction << ties;
      }
}

// By itself, on a hinge, and beside bodies that are tied: no tie is to blame.
TEST(Guard, BlamesASpinThatNoStepsCanFollow) {
  const std::string top = R"("name": "top", "shape": {"box": {"size": [0.2, 0.3, 0.4]}}, "position": [0, 1, 0])";
  const std::string spin = R"("angularVelocity": [1e8, 3e7, 1e9])";
  const std::string floor = R"({"name": "floor", "shape": {"plane": {}}, "motion": "static"})";
  const std::string hung = R"({"name": "hung", "shape": {"sphere": {"radius": 0.1}}, "position": [1, 1, 0]})";
  for (const std::string& rest :
       {fmt::format(R"("bodies": [{{{}, {}}}, {}])", top, spin, floor),
        fmt::format(R"("bodies": [{{{}, "angularVelocity": [0, 0, 1e9]}}, {}],
          "hinges": [{{"bodyA": "top", "anchorA": [0, 0, 0.1], "anchorB": [0, 1, 0.1], "axis": [0, 0, 1]}}])",
                    top, floor),
        fmt::format(R"("bodies": [{{{}, {}}}, {}, {}], "rods": [{{"bodyA": "hung", "anchorB": [1, 2, 0]}}])", top, spin,
                    floor, hung)}) {
    const Outcome outcome = outcomeOf(sceneMovedBy(R"("accuracy": 1e-9)", 1, rest));
    EXPECT_THAT(outcome.failure, AllOf(HasSubstr("body \"top\" spins at 1"), HasSubstr("e+09 rad/s"),
                                       Not(HasSubstr("ties")), Not(HasSubstr("rods"))));
  }
}

TEST(Guard, NamesABodyThatSpinsTooFarInAStep) {
  for (const char* method : {"explicitEuler", "semiImplicitEuler", "rk4", "dop853"}) {
    const Outcome outcome = outcomeOf(sceneMovedBy(methodText(method, 0.3), 20, R"("gravity": [0, 0, 0],
      "bodies": [{"name": "box", "shape": {"box": {"size": [0.1, 0.2, 0.3]}}, "angularVelocity": [10, 0.1, 20]}])"));
    EXPECT_THAT(outcome.failure, AllOf(HasSubstr("unstable at"), HasSubstr("body \"box\" turns by"))) << method;
  }
}

/// A ball of 1 kg at rest on a spring without tension.
class AdaptiveGuard : public ::testing::Test {
 protected:
  Scene scene_ = sceneMovedBy(R"("accuracy": 1e-6)", 1, R"(
    "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1}],
    "springs": [{"name": "s", "bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0], "stiffness": 10}])");
  IslandPlan plan_ = planOf(scene_).islands.at(0);
  Assembly assembly_ = assemble(scene_, plan_);
  EnergyGuard guard_{assembly_, assembly_.state, plan_.method, scene_.duration};
};

// One step with local errors of 2e-8 (1 + |y|): the weight of 9.81 N and the dissipated joule have a part of 2.2e-7 J,
// and a hundred times that is allowed.
TEST_F(AdaptiveGuard, AllowsNoMoreThanTheLocalErrorsDo) {
  VectorX state = assembly_.state;
  linearVelocity(state, 0) = Vec3(std::sqrt(2 * 1e-5), 0, 0);
  guard_.check(state, 0.1, 0.1);
  linearVelocity(state, 0) = Vec3(std::sqrt(2 * 1e-4), 0, 0);
  EXPECT_THROW(guard_.check(state, 0.1, 0.1), Error);
}

TEST_F(AdaptiveGuard, WantsAFiniteState) {
  VectorX state = assembly_.state;
  state[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(guard_.check(state, 0.1, 0.1), Error);
}

}  // namespace
}  // namespace cradle
