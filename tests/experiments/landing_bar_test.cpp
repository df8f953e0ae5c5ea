// A bar that comes down nearly flat touches with one end, and within the same step with the other. A model that tips
// over an edge comes down with its face.

#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/experiment.h"
#include "math/rotation.h"

namespace cradle {
namespace {

struct Landing {
  double tilt = 0, restitution = 0, accuracy = 1e-6;
  double width = 4;  // m, of the plate along the bar, which is 1 m long and 0.1 m thick; a tenth of it across
  std::string method = "";
};

Trajectory landingOf(const Landing& landing, double framesPerSecond) {
  return simulate(sceneWith(fmt::format(
      R"("duration": 0.4, "accuracy": {}, {} "output": {{"framesPerSecond": {}}},
         "materials": {{"m": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}},
         "bodies": [{{"name": "plate", "motion": "static", "shape": {{"box": {{"size": [{}, 0.1, {}]}}}},
                      "position": [0, -0.05, 0], "material": "m"}},
                    {{"name": "bar", "shape": {{"box": {{"size": [1, 0.1, 0.1]}}}}, "mass": 1, "position": [0, 0.25, 0],
                      "orientation": {{"w": {}, "x": 0, "y": 0, "z": {}}}, "material": "m"}}])",
      landing.accuracy, landing.method, framesPerSecond, landing.restitution, landing.width, landing.width / 10,
      std::cos(landing.tilt / 2), std::sin(landing.tilt / 2))));
}

/// m: how deep the bar's lower face, or its ends, are in the plate; the bar turns about z only.
double depthOf(const BodyState& bar, double width) {
  double depth = -1;
  for (const double end : {-0.5, 0.5}) {
    const Vec3 corner = bar.position + bar.orientation * Vec3(end, -0.05, 0);
    if (std::abs(corner.x()) < width / 2) depth = std::max(depth, -corner.y());
    const Vec3 edge = bar.orientation.conjugate() * (Vec3(end * width, 0, 0) - bar.position);
    if (std::abs(edge.x()) < 0.5) depth = std::max(depth, edge.y() + 0.05);
  }
  return depth;
}

// Frames every ms: nothing overlaps by more than the interpolant's error. The plate is wider than the bar, whose
// corners touch then, or smaller, and its corners touch the bar's face.
TEST(LandingBar, IsNeverInThePlate) {
  for (const double width : {4.0, 0.6})
    for (const double restitution : {0.0, 0.5, 1.0})
      for (const double tilt : {1e-2, 1e-4, 1e-7}) {
        const Trajectory run = landingOf({tilt, restitution, 1e-6, width}, 1000);
        double deepest = -1;
        for (const Frame& frame : run.frames) deepest = std::max(deepest, depthOf(frame.states[0], width));
        EXPECT_LT(deepest, 1e-7) << width << " " << restitution << " " << tilt;
      }
}

// In steps of 1/240 s it comes down by 8 mm in each, and touches with one end while the other comes on. What is seen at
// the steps' ends is how well a landing is found: bodies turn by 0.03 rad in a step at most, and its cube is 2e-5, in m
// and of the energy (J, 2.5 of them) that a bar has which events find landing.
TEST(LandingBar, LandsInStepsAsByEvents) {
  for (const double width : {4.0, 0.6})
    for (const double restitution : {0.0, 0.5})
      for (const double tilt : {3e-2, 1e-2, 1e-3, 1e-4}) {
        const Landing landing{tilt, restitution, 1e-3, width, methodText("rk4", 1.0 / 240) + ","};
        const Trajectory run = landingOf(landing, 240), exact = landingOf({tilt, restitution, 1e-9, width}, 240);
        double deepest = -1, energyError = 0;
        for (std::size_t i = 0; i < run.frames.size(); ++i) {
          deepest = std::max(deepest, depthOf(run.frames[i].states[0], width));
          energyError =
              std::max(energyError, std::abs(mechanicalEnergy(run.frames[i]) - mechanicalEnergy(exact.frames[i])));
        }
        EXPECT_LT(deepest, 2e-5) << width << " " << restitution << " " << tilt;
        if (restitution == 0) {  // rebounds in a step are not told apart
          EXPECT_LT(energyError, 2e-5) << width << " " << tilt;
        }
      }
}

// At an accuracy of 1e-12 steps are several times shorter and touches a thousand times closer.
TEST(LandingBar, DoesNotDependOnTheSteps) {
  for (const double width : {4.0, 0.6})
    for (const double tilt : {1e-2, 1e-4}) {
      const Trajectory coarse = landingOf({tilt, 0.5, 1e-6, width}, 10),
                       fine = landingOf({tilt, 0.5, 1e-12, width}, 10);
      const BodyState a = endOf(coarse), b = endOf(fine);
      EXPECT_LT((a.position - b.position).norm(), 1e-5) << width << " " << tilt;
      EXPECT_LT(orientationError(a.orientation, b.orientation), 1e-5) << width << " " << tilt;
    }
}

/// m: how deep the lowest corner of assets/l_prism.3ds is below the height `top`.
double depthOfPrism(const BodyState& prism, double scale, double top) {
  double depth = -INFINITY;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.3, 0.0}, {0.3, 0.1}, {0.1, 0.1}, {0.1, 0.2}, {0.0, 0.2}})
    for (const double z : {0.0, 0.1}) {
      const Vec3 corner = scale * (Vec3(x, y, z) - Vec3(0.125, 0.075, 0.05));  // about the centre of mass
      depth = std::max(depth, top - (prism.position + prism.orientation * corner).y());
    }
  return depth;
}

// An L prism that falls over its edge onto its face, on the end of a cylinder that moves. The far corners of the face
// are no contacts before it has come down, and it comes down within one step.
TEST(LandingPrism, TipsOntoACylinder) {
  for (const char* shape :
       {R"({"cylinder": {"radius": 0.34868, "length": 0.034868}})", R"({"box": {"size": [0.7, 0.034868, 0.7]}})"})
    for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
      const std::string text = fmt::format(
          R"({{"schema": "cradle-scene/1", "name": "Prism", "duration": 0.14, "accuracy": {}, "output": {{"framesPerSecond": 240}},
             "materials": {{"m": {{"restitution": 0, "staticFriction": 3, "dynamicFriction": 1.7607}}}},
             "bodies": [{{"name": "table", "motion": "driven", "shape": {}, "material": "m",
                "oscillation": {{"direction": [1, 0, 0], "amplitude": 0.034868, "frequency": 1.1939, "phase": 2.91}}}},
               {{"name": "prism", "shape": {{"mesh": "{}/assets/l_prism.3ds", "scale": 0.2552}}, "material": "m",
                "mass": 69.1, "position": [0, 0.0174354, 0], "orientation": {{"w": 0.8585833269748705,
                "x": -0.13394969446873428, "y": -0.44841726944331023, "z": 0.20931818472722621}}}}]}})",
          accuracy, shape, CRADLE_SOURCE_DIR);
      const Trajectory run = simulate(parseScene(text, "prism.json", modelFilesBeside("prism.json")).scene);
      double deepest = -1, highest = -1;
      for (const Frame& frame : run.frames) {
        deepest = std::max(deepest, depthOfPrism(frame.states[1], 0.2552, 0.017434));
        highest = std::max(highest, -depthOfPrism(frame.states[1], 0.2552, 0.017434));
      }
      EXPECT_LT(deepest, 1e-9) << shape << accuracy;
      EXPECT_LT(highest, 1e-5) << shape << accuracy;
      EXPECT_LT(std::abs(run.frames.back().energy.numerical), 13 * accuracy) << shape;  // J, of 13
    }
}

}  // namespace
}  // namespace cradle
