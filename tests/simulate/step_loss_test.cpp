#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/experiment.h"

namespace cradle {
namespace {

// A swing of 0.1 rad on an arm of 1 m for 10 s, of a bob that a rod, a ball joint or a hinge holds.
const std::string kRod = R"("rods": [{"bodyA": "b", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0]}])",
                  kBallJoint = R"("ballJoints": [{"bodyA": "b", "anchorA": [0, 1, 0], "anchorB": [0, 1, 0]}])",
                  kHinge = R"("hinges": [{"bodyA": "b", "anchorA": [0, 1, 0], "anchorB": [0, 1, 0],
                              "axis": [0, 0, 1]}])";

struct WatchedSwing {
  std::string warning;
  double lost = 0, largestKinetic = 0;  // J
};

WatchedSwing swing(const std::string& tie, const std::string& method, double timeStep) {
  const double angle = 0.1;
  const bool isRod = tie == kRod;
  WatchedSwing result;
  simulate(sceneWith(fmt::format(R"("duration": 10, "method": {{"name": "{}", "timeStep": {}}}, {}, "bodies": [
             {{"name": "b", "shape": {{"sphere": {{"radius": 0.01}}}}, "mass": 1, "position": [{}, {}, 0],
             "orientation": {{"axis": [0, 0, 1], "angleDegrees": {}}}}}])",
                                 method, timeStep, tie, std::sin(angle), 1 - std::cos(angle),
                                 isRod ? 0 : angle * 180 / M_PI)),
           {[&](const Frame& frame) {
              result.largestKinetic = std::max(result.largestKinetic, frame.energy.kinetic);
              result.lost = frame.energy.numerical;
            },
            [](const Event&) {}, [&](const std::string& text) { result.warning += text; }});
  return result;
}

// RK4 leaves 1 - z^6 / 72 + z^8 / 576 of the energy in a step, z = h omega: a quarter is lost in ten seconds with h =
// 0.3 s.
TEST(StepLoss, OfPendulumsIsToldWithAStepThatIsHarmless) {
  for (const std::string& tie : {kRod, kBallJoint, kHinge})
    for (const double timeStep : {0.3, 0.4}) {
      const WatchedSwing wrong = swing(tie, "rk4", timeStep);
      ASSERT_NE(wrong.warning.find("alone take"), std::string::npos) << tie << wrong.warning;
      EXPECT_GT(wrong.lost, 0.2 * wrong.largestKinetic) << tie;
      const std::size_t at = wrong.warning.find("\"timeStep\" of ");
      ASSERT_NE(at, std::string::npos);
      const WatchedSwing right = swing(tie, "rk4", std::stod(wrong.warning.substr(at + 14)));
      EXPECT_EQ(right.warning, "") << tie;
      EXPECT_LT(std::abs(right.lost), 0.02 * right.largestKinetic) << tie;
    }
}

// A ball on the floor whose joint lets it neither roll nor slide: what its start velocity loses is no matter of steps,
// and rounding of nothing is no loss. Without gravity, forces of rounding are not told of either.
TEST(StepLoss, IsNotToldOfWhatDoesNotMove) {
  for (const char* run :
       {R"("method": {"name": "rk4", "timeStep": 0.001})", R"("gravity": [0, 0, 0], "accuracy": 1e-2)"}) {
    std::vector<std::string> warnings;
    simulate(sceneWith(fmt::format(R"("duration": 0.1, {}, "bodies": [
               {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static"}},
               {{"name": "b", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [0.3, 0.1, 0],
                 "linearVelocity": [1.1, -0.3, 0], "angularVelocity": [0, 0, -1]}}],
               "ballJoints": [{{"bodyA": "b", "anchorA": [-0.3, -1.1, 0], "anchorB": [0, -1, 0]}}])",
                                   run)),
             {[](const Frame&) {}, [](const Event&) {}, [&](const std::string& text) { warnings.push_back(text); }});
    EXPECT_EQ(std::ssize(warnings),
              std::count_if(warnings.begin(), warnings.end(),
                            [](const std::string& text) { return text.find("start velocities") != std::string::npos; }))
        << run << (warnings.empty() ? "" : warnings.back());
  }
}

// A spring elsewhere, whose swing the steps keep, does not hide it.
TEST(StepLoss, OfAPendulumBesideASpringIsTold) {
  const std::string spring = R"("springs": [{"bodyA": "b", "anchorA": [0, 0, 0], "anchorB": [0, -20, 0],
                                             "stiffness": 1e-3, "restLength": 20}])";
  EXPECT_NE(swing(kHinge + ", " + spring, "rk4", 0.3).warning.find("alone take"), std::string::npos);
}

// A symplectic step's energy swings about what it was: z / 2 of it, and nothing is lost.
TEST(StepLoss, IsNotToldOfEnergyThatComesBack) {
  EXPECT_EQ(swing(kRod, "rk4", 0.02).warning, "");
  EXPECT_EQ(swing(kRod, "semiImplicitEuler", 0.02).warning, "");
}

TEST(StepLoss, GainsAreToldToo) {
  EXPECT_NE(swing(kRod, "explicitEuler", 0.002).warning.find("alone add"), std::string::npos);
}

}  // namespace
}  // namespace cradle
