#include "study/run_quantity.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "scene/load_scene.h"
#include "simulate/simulate.h"
#include "simulate/world.h"
#include "study/run_chart.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A scene that was simulated.
struct Made {
  explicit Made(const std::string& members, const std::string& motion = R"("duration": 2, "accuracy": 1e-10, )")
      : scene(parseScene(R"({"schema": "cradle-scene/1", "name": "made", )" + motion +
                             R"("output": {"framesPerSecond": 100}, )" + members + "}",
                         "made.json", {})
                  .scene) {
    World world(scene);
    TrajectoryWriter writer(headerOf(scene, world.plan()));
    SimulationSink sink{};
    sink.frame = [&](const Frame& frame) { writer.append(frame); };
    sink.event = [&](const Event& event) { writer.append(event); };
    writer.finish(simulate(scene, world, sink));
    reader.emplace(writer);
  }

  PlottedRun run(const std::string& name = "made") const { return {{name, scene}, *reader}; }

  Scene scene;
  std::optional<TrajectoryReader> reader;
};

std::string ball(const char* name, const char* position, const char* velocity) {
  return fmt::format(
      R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "collision": "none", "position": {}, "linearVelocity": {}}})",
      name, position, velocity);
}

QuantityCurve curveOf(const std::string& quantity, const Made& made, const PlottedRun* reference = nullptr) {
  return curvesOf(parseQuantities(quantity).at(0), made.run(), false, reference).at(0);
}

// A rod of 2 m about (1, 5, 0), struck so hard that it goes over the top: w^2 / 2 - g / l cos(angle) is constant. The
// local error of 1e-10 grows to 1e-8 in 2 s at most.
TEST(RunQuantity, AngleOfAPendulumGoesWithItsRate) {
  const Made made(R"("bodies": [)" + ball("bob", "[1, 3, 0]", "[-12, 0, 0]") +
                  R"(], "rods": [{"bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [1, 5, 0]}])");
  const QuantityCurve angle = curveOf("angle:bob", made), phase = curveOf("phase:bob", made);
  EXPECT_EQ(phase.x, angle.y);
  EXPECT_DOUBLE_EQ(phase.x[0], 0);
  EXPECT_DOUBLE_EQ(phase.y[0], 6);
  EXPECT_GT(angle.y.back(), 2 * M_PI);  // whole turns are counted
  for (std::size_t i = 0; i < angle.y.size(); ++i)
    EXPECT_NEAR(phase.y[i] * phase.y[i] / 2 - 9.81 / 2 * std::cos(phase.x[i]), 18 - 9.81 / 2, 1e-7) << i;
}

// The pivot of the lower bob is the upper one: at the start its rod is level, 1 m long, and the upper bob moves up
// by 1 m/s, the lower one down by 2 m/s.
TEST(RunQuantity, PivotsMayMove) {
  const Made made(R"("bodies": [)" + ball("upper", "[1, 0, 0]", "[0, 1, 0]") + ", " +
                  ball("lower", "[2, 0, 0]", "[0, -2, 0]") +
                  R"(], "rods": [{"bodyA": "upper", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]},
                      {"bodyA": "lower", "anchorA": [0, 0, 0], "bodyB": "upper", "anchorB": [0, 0, 0]}])");
  const QuantityCurve lower = curveOf("phase:lower", made), upper = curveOf("phase:upper", made);
  EXPECT_NEAR(lower.x[0], M_PI / 2, 1e-12);
  EXPECT_NEAR(lower.y[0], -3, 1e-12);
  EXPECT_NEAR(upper.x[0], M_PI / 2, 1e-12);
  EXPECT_NEAR(upper.y[0], 1, 1e-12);
}

// About a hinge both are the same but for where they begin. (Coordinates are integrals of velocities: 1e-8 as above.)
TEST(RunQuantity, AnglesOfBodiesAreThoseOfTheirHinges) {
  const Made made(R"("bodies": [)" + ball("bob", "[1, 0, 0]", "[0, 0, 0]") +
                  R"(], "hinges": [{"name": "pin", "bodyA": "bob", "anchorA": [-1, 0, 0], "anchorB": [0, 0, 0],
                      "axis": [0, 0, 1]}])");
  const QuantityCurve body = curveOf("phase:bob", made), joint = curveOf("phase:pin", made);
  ASSERT_EQ(body.x.size(), joint.x.size());
  EXPECT_NEAR(body.x[0], M_PI / 2, 1e-12);
  for (std::size_t i = 0; i < body.x.size(); ++i) {
    EXPECT_NEAR(body.x[i] - body.x[0], joint.x[i], 1e-7);
    EXPECT_NEAR(body.y[i], joint.y[i], 1e-7);
  }
}

// Without gravity: one goes by 3 m/s along x, the other by 3 and 4 m/s along x and z.
TEST(RunQuantity, ErrorsAreDistancesFromTheReference) {
  const char* motion = R"("duration": 1, "gravity": [0, 0, 0], )";
  const Made made(
      R"("bodies": [)" + ball("a", "[0, 0, 0]", "[3, 0, 0]") + ", " + ball("b", "[0, 9, 0]", "[0, 0, 0]") + "]",
      motion),
      other(R"("bodies": [)" + ball("a", "[0, 0, 0]", "[3, 0, 4]") + ", " + ball("b", "[0, 9, 0]", "[9, 0, 0]") + "]",
            motion);
  const PlottedRun reference = other.run("the reference");
  const QuantityCurve one = curveOf("error:a", made, &reference), all = curveOf("error", made, &reference);
  for (std::size_t i = 1; i < one.x.size(); ++i) {
    EXPECT_NEAR(one.y[i], 4 * one.x[i], 1e-12);
    EXPECT_NEAR(all.y[i], 9 * one.x[i], 1e-12);
  }
  EXPECT_TRUE(std::isnan(one.y[0]));  // none, which a logarithmic axis has not
}

// A ball that falls from rest: m g t^2 / 2 goes from one to the other.
TEST(RunQuantity, EnergyHasItsPartsIfThereIsOneRun) {
  const Made made(R"("bodies": [)" + ball("a", "[0, 5, 0]", "[0, 0, 0]") + "]", R"("duration": 1, )");
  const auto parts = curvesOf({QuantityKind::energy, ""}, made.run(), true, nullptr);
  ASSERT_EQ(parts.size(), 3u);
  const double weight = made.scene.bodies[0].massProperties.mass * 9.81, lost = weight * 9.81 / 2;
  EXPECT_NEAR(parts[0].y.back(), lost, 1e-12 * lost);
  EXPECT_NEAR(parts[1].y.front(), lost, 1e-12 * lost);
  EXPECT_EQ(parts[1].y.back(), 0);
  EXPECT_EQ(curvesOf({QuantityKind::energy, ""}, made.run(), false, nullptr).size(), 1u);
  EXPECT_NEAR(curveOf("height:a", made).y.back(), 5 - 9.81 / 2, 1e-12);
}

TEST(RunQuantity, WhatTheSceneHasNotIsRefused) {
  const Made made(R"("bodies": [)" + ball("a", "[0, 5, 0]", "[0, 0, 0]") + "]", R"("duration": 0.1, )");
  for (const char* text : {"height:b", "angle:b", "angle:a", "phase:a", "error:b"})
    EXPECT_THROW(requireQuantity(parseQuantities(text)[0], made.run()), Error) << text;
  for (const char* text : {"", "height", "height:", "energy:a", "speed:a", "energy,,error", "error,"})
    EXPECT_THROW(parseQuantities(text), Error) << text;
  EXPECT_EQ(parseQuantities("energy,error,height:a,phase:a b").size(), 4u);
}

TEST(RunQuantity, NamesMayHaveCommas) {
  const Made made(R"("bodies": [)" + ball("a, b", "[0, 5, 0]", "[0, 0, 0]") + ", " +
                      ball("a", "[0, 6, 0]", "[0, 0, 0]") + ", " + ball("b,energy", "[0, 7, 0]", "[0, 0, 0]") + "]",
                  R"("duration": 0.1, )");
  const std::vector<std::string> names = namesWithCommas(made.scene);
  EXPECT_THAT(names, ::testing::ElementsAre("a, b", "b,energy"));
  const auto read = [&](const std::string& text) {
    std::vector<std::string> found;
    for (const RunQuantity& quantity : parseQuantities(text, names)) {
      requireQuantity(quantity, made.run());
      found.push_back(quantity.name);
    }
    return found;
  };
  EXPECT_THAT(read("height:a, b"), ::testing::ElementsAre("a, b"));
  EXPECT_THAT(read("energy,height:a, b,height:a,energyError"), ::testing::ElementsAre("", "a, b", "a", ""));
  EXPECT_THAT(read("height:a,energy"), ::testing::ElementsAre("a", ""));
  EXPECT_THAT(read("height:b,energy,energy"), ::testing::ElementsAre("b,energy", ""));
  EXPECT_THROW(parseQuantities("height:a, b"), Error);
  EXPECT_THROW(parseQuantities("height:a, bc", names), Error);
}

TEST(RunChart, LongTextsAreWrappedAndSmaller) {
  EXPECT_EQ(fittedForGnuplot("it's", 15, 460, 80).command, "'it''s' font ',15'");
  std::string name;
  while (name.size() < 240) name += "Pendulum `date` \\n $x ";
  const std::string fitted = fittedForGnuplot(name, 15, 460, 80).command;
  EXPECT_THAT(fitted, HasSubstr("'.\"\\n\".'"));
  EXPECT_THAT(fitted, Not(HasSubstr("font ',15'")));
  std::string words;  // all that is in single quotes
  bool isInside = false;
  for (const char c : fitted.substr(0, fitted.rfind(" font")))
    if (c == '\'')
      isInside = !isInside;
    else if (isInside && c != ' ')
      words += c;
  std::erase(name, ' ');
  EXPECT_EQ(words, name);
}

// Names of 60 letters: two do not fit beside each other on 1300 pixels, and five take five rows.
TEST(RunChart, LegendHasRowsForItsNames) {
  RunPanel panel{{"time (s)", "energy (J)"}, {}, {}};
  for (char letter = 'a'; letter < 'f'; ++letter)
    panel.curves.push_back({std::string(60, letter), {0, 1}, {1, 2}}), panel.hasFailed.push_back(0);
  EXPECT_THAT(runChartCommands("t", {panel}, ChartFormat::svg), HasSubstr("maxrows 5"));
  for (QuantityCurve& curve : panel.curves) curve.name.resize(30);
  EXPECT_THAT(runChartCommands("t", {panel}, ChartFormat::svg), HasSubstr("maxrows 3"));
  for (QuantityCurve& curve : panel.curves) curve.name.resize(5);
  EXPECT_THAT(runChartCommands("t", {panel}, ChartFormat::svg), HasSubstr("maxrows 2"));
  panel.curves[0].name = std::string(250, 'w');
  EXPECT_THAT(runChartCommands("t", {panel}, ChartFormat::svg), HasSubstr("maxrows 5"));
}

TEST(RunChart, CurvesThatFailEndAtACross) {
  RunPanel panel{{"time (s)", "energy (J)"}, {{"good", {0, 1, 2}, {1, 1, 1}}, {"bad", {0, 1}, {1, 1e30}}}, {0, 1}};
  const std::string commands = runChartCommands("it's", {panel}, ChartFormat::svg);
  EXPECT_THAT(commands, HasSubstr("$end0_1 << EOD\n1 1e+30\nEOD"));
  EXPECT_THAT(commands, Not(HasSubstr("$end0_0")));
  EXPECT_THAT(commands, HasSubstr("title 'good'"));
  EXPECT_THAT(commands, HasSubstr("'it''s'"));
}

}  // namespace
}  // namespace cradle
