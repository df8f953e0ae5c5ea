// The map of accuracies, and how maps are put together.

#include <gmock/gmock.h>

#include <cmath>

#include "dynamics/free_rotation.h"
#include "study/motion_error.h"
#include "study/stability/fixed_step_trial.h"
#include "study/stability/smooth_motion_maps.h"
#include "study/stability/tumbling.h"

namespace cradle {
namespace {

void noProgress(double) {}

/// The curve whose name begins so.
const MapCurve& curveOf(const StabilityMap& map, const std::string& name) {
  for (const MapCurve& curve : map.panels[0].curves)
    if (curve.name.starts_with(name)) return curve;
  throw std::logic_error("no such curve");
}

double errorAt(const MapCurve& curve, double accuracy) {
  for (const MapPoint& point : curve.points)
    if (std::abs(point.x / accuracy - 1) < 1e-9) return point.y;
  throw std::logic_error("no such accuracy");
}

/// By how much the closed form makes an error of the angular velocity larger until 10 s, of any of its components and
/// made at any time: a little of it on the way over changes much in how near the motion is to that which never turns
/// over. Linear in the error, for one as small as this.
double growthOfErrors() {
  const double error = 1e-8;  // rad/s
  const Body body = tumblingScene(5).bodies[0];
  const Mat3& inertiaTensor = body.massProperties.inertiaTensor;
  const FreeRotation truth(inertiaTensor, {Quat::Identity(), body.angularVelocity});
  const std::vector<BodyState> end{{Vec3::Zero(), truth.at(10).worldFromBody}};
  double growth = 0;
  for (double time = 0; time < 10; time += 0.05)
    for (int axis = 0; axis < 3; ++axis) {
      RotationState start = truth.at(time);
      start.angularVelocity += error * Vec3::Unit(axis);
      const FreeRotation other(inertiaTensor, start);
      growth = std::max(growth, motionError({{Vec3::Zero(), other.at(10 - time).worldFromBody}}, end) / error);
    }
  return growth;
}

// DOP853's error estimate goes with the eighth power of the step, and so does the error at the end: it goes with the
// accuracy. A method of order 7, or 9, would have 7/8, or 9/8 of that power; steps whose errors happen to
// cancel, by a factor of 3 at one of the ends, are 0.1 of it. Coarser, what turns over is lost; finer,
// rounding is near.
TEST(AccuracyMap, HasErrorsThatGoDownATenthForATenth) {
  const StabilityMap map = accuracyMap(noProgress);
  ASSERT_EQ(map.panels[0].curves.size(), 6U);
  for (const MapCurve& curve : map.panels[0].curves) {
    if (curve.kind == CurveKind::theory) continue;
    const double order = std::log10(errorAt(curve, 1e-5) / errorAt(curve, 1e-10)) / 5;
    EXPECT_NEAR(order, 1, 1.0 / 8 + 0.1) << curve.name;
  }
}

// The tolerance of a step is a fiftieth of the accuracy, scaled by 1 + |x|, at 5 rad/s 6: fifty steps at the worst time
// leave 6 accuracies, and less if not all are at the worst; the errors of five there, of a component near zero, leave a
// tenth. Of a damped spring's errors exp(-0.05 x 2 pi x 10) = 0.04 is left.
TEST(AccuracyMap, HasErrorsAsTheMotionMakesThemGrow) {
  const StabilityMap map = accuracyMap(noProgress);
  const double growth = growthOfErrors();
  EXPECT_GT(growth, 1000);
  for (const double accuracy : {1e-5, 1e-7, 1e-9}) {
    EXPECT_LT(errorAt(curveOf(map, "mass on a damped spring"), accuracy), 0.1 * accuracy);
    EXPECT_LT(errorAt(curveOf(map, "free body that turns over"), accuracy), 6 * growth * accuracy);
    EXPECT_GT(errorAt(curveOf(map, "free body that turns over"), accuracy), 0.1 * growth * accuracy);
  }
}

TEST(MapCells, AreInRowsAlongYAndProgressGoesToOne) {
  StabilityMap map;
  map.x = linearAxis("x", "", {1, 2, 3});
  map.y = linearAxis("y", "", {10, 20});
  std::vector<double> parts;
  const auto cells = cellsOf(
      map, [](double x, double y) { return x + y; }, [&](double part) { parts.push_back(part); });
  EXPECT_THAT(cells, ::testing::ElementsAre(11, 12, 13, 21, 22, 23));
  EXPECT_THAT(parts, ::testing::ElementsAre(0.5, 1));
}

TEST(MapPanels, AreOneOfEachMethodInTheirOrder) {
  StabilityMap map;
  std::vector<double> parts;
  addPanels(
      map,
      [](const FixedStepMethod& method, const MapProgress& progress) {
        progress(1);
        return MapPanel{method.name, {}, {}};
      },
      [&](double part) { parts.push_back(part); });
  ASSERT_EQ(map.panels.size(), fixedStepMethods().size());
  for (std::size_t i = 0; i < map.panels.size(); ++i) EXPECT_EQ(map.panels[i].title, fixedStepMethods()[i].name);
  EXPECT_THAT(parts, ::testing::ElementsAre(0.25, 0.5, 0.75, 1));
}

// Of the maps that take least: their points are where their axes are, and their texts fit.
TEST(StabilityMaps, AreCompleteAndWithinTheirAxes) {
  for (const MapEntry& entry : stabilityMaps()) {
    if (entry.seconds > 0.25) continue;
    double told = 0;
    const StabilityMap map = entry.make([&](double part) { told = part; });
    EXPECT_EQ(map.name, entry.name);
    EXPECT_EQ(told, 1) << map.name;
    EXPECT_LE(map.subtitle.size(), 160U) << map.name;
    EXPECT_THAT(map.panels.size(), ::testing::AllOf(::testing::Ge(1U), ::testing::Le(6U))) << map.name;
    for (const MapPanel& panel : map.panels) {
      EXPECT_FALSE(panel.curves.empty()) << map.name;
      for (const MapCurve& curve : panel.curves)
        for (const MapPoint& point : curve.points) {
          if (curve.kind != CurveKind::series) continue;
          if (!map.x.values.empty()) {
            EXPECT_GE(point.x, map.x.values[0]);
            EXPECT_LE(point.x, map.x.values.back());
          }
          if (!map.y.values.empty()) {
            EXPECT_GE(point.y, map.y.values[0]);
            EXPECT_LE(point.y, map.y.values.back());
          }
        }
    }
  }
}

}  // namespace
}  // namespace cradle
