#include <gtest/gtest.h>

#include "experiments/experiment.h"

// Pendulums of point masses on massless rods of 1 m, released horizontally. Reference values to 20 digits: the simple
// pendulum in elliptic functions, the double one by extrapolation of order 24 in minimal and in maximal coordinates.

namespace cradle {
namespace {

constexpr const char* kMethods[] = {"explicitEuler", "semiImplicitEuler", "rk4"};

std::string bobText(const std::string& name, double x) {
  return fmt::format(R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.01}}}}, "collision": "none", "mass": 1,
    "position": [{}, 0, 0]}})",
                     name, x);
}

Trajectory swing(const std::string& bodies, const std::string& rods, const std::string& method, double duration) {
  return simulate(sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Pendulum", "duration": {},
    "output": {{"framesPerSecond": 10}}, {}, "bodies": [{}], "rods": [{}]}})",
                                      duration, method, bodies, rods)));
}

Trajectory swingOne(const std::string& method, double duration) {
  return swing(bobText("bob", -1), R"({"bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]})", method, duration);
}

Trajectory swingTwo(const std::string& method, double duration) {
  return swing(bobText("upper", 1) + "," + bobText("lower", 2),
               R"({"bodyA": "upper", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]},
                  {"bodyA": "lower", "anchorA": [0, 0, 0], "bodyB": "upper", "anchorB": [0, 0, 0]})",
               method, duration);
}

using Positions = std::vector<Vec3>;
double distance(const Trajectory& run, const Positions& expected) {
  double largest = 0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    largest = std::max(largest, (run.frames.back().states[i].position - expected[i]).norm());
  return largest;
}

/// Errors at the steps h, h/2, h/4, h/8.
template <class Swing>
std::vector<double> errorsOf(const Swing& swing, const std::string& method, double coarsest, double duration,
                             const Positions& expected) {
  std::vector<double> errors;
  for (int halving = 0; halving < 4; ++halving)
    errors.push_back(distance(swing(methodText(method, coarsest / (1 << halving)), duration), expected));
  return errors;
}

const Positions kOneAt2 = {{-0.79356619534332174699, -0.60848393044379151463, 0}};
const Positions kOneAt10 = {{-0.27508746257611686005, -0.96141920509912506427, 0}};
const Positions kTwoAt1 = {{-0.58516839199887506894, -0.81091180346906462094, 0},
                           {-1.4448188499434757965, -1.3217944613814645558, 0}};
const Positions kTwoAt2 = {{-0.46441286869951397749, -0.88561881607511478534, 0},
                           {-1.4341248174642766370, -1.1298701956471579784, 0}};
const Positions kTwoAt5 = {{-0.58686920981627114532, -0.80968174647180080514, 0},
                           {-1.5507784694704428004, -1.0759127348126524565, 0}};

// The next term of the error bends the slope by the ratio of step and time scale, below a tenth at these steps.
constexpr double kOrderTolerance = 0.15;

TEST(SimplePendulum, HasTheOrderOfItsMethodAfterTwoSeconds) {
  EXPECT_NEAR(measuredOrder(errorsOf(swingOne, "explicitEuler", 1.0 / 4096, 2, kOneAt2)), 1, kOrderTolerance);
  EXPECT_NEAR(measuredOrder(errorsOf(swingOne, "semiImplicitEuler", 1.0 / 1024, 2, kOneAt2)), 1, kOrderTolerance);
  EXPECT_NEAR(measuredOrder(errorsOf(swingOne, "rk4", 1.0 / 64, 2, kOneAt2)), 4, kOrderTolerance);
}

TEST(DoublePendulum, HasTheOrderOfItsMethod) {
  EXPECT_NEAR(measuredOrder(errorsOf(swingTwo, "explicitEuler", 1.0 / 8192, 1, kTwoAt1)), 1, kOrderTolerance);
  EXPECT_NEAR(measuredOrder(errorsOf(swingTwo, "semiImplicitEuler", 1.0 / 4096, 1, kTwoAt1)), 1, kOrderTolerance);
  EXPECT_NEAR(measuredOrder(errorsOf(swingTwo, "rk4", 1.0 / 256, 2, kTwoAt2)), 4, kOrderTolerance);
}

// A step of RK4 leaves out (w h)^5 / 120 of its way at the angular speed w; over the time t that is t w^5 h^4 / 120,
// times what a disturbance grows by until then. Simple: w at most sqrt(2 g) = 4.43 rad/s, growth t w / 2 in phase at
// most (the period depends on the energy). Double: growth 12.7 until 5 s; its fastest bob turns at 8 rad/s.
TEST(SimplePendulum, Rk4IsWithinItsErrorAfterTenSeconds) {
  const double h = 1.0 / 1024, speed = std::sqrt(2 * 9.81), time = 10;
  const double bound = time * std::pow(speed, 5) * std::pow(h, 4) / 120 * (1 + time * speed / 2);
  EXPECT_LT(distance(swingOne(methodText("rk4", h), time), kOneAt10), bound);
}

TEST(DoublePendulum, Rk4IsWithinItsErrorAfterFiveSeconds) {
  const double h = 1.0 / 1024, speed = 8, time = 5, growth = 12.72;
  const double bound = time * std::pow(speed, 5) * std::pow(h, 4) / 120 * growth;
  EXPECT_LT(distance(swingTwo(methodText("rk4", h), time), kTwoAt5), bound);
}

// Lengths are restored after every step: what is left is the rounding of coordinates below 2 m, 2.2e-16 each, squared
// and summed: a few 1e-16; at the frames that lie inside no step, which these do.
TEST(Rods, KeepTheirLengthsToRoundingInEveryFrameOfEveryMethod) {
  for (const char* method : kMethods) {
    const Trajectory one = swingOne(methodText(method, 1.0 / 1000), 5), two = swingTwo(methodText(method, 0.001), 5);
    for (const Frame& frame : one.frames) EXPECT_NEAR(frame.states[0].position.norm(), 1, 5e-15) << method;
    for (const Frame& frame : two.frames) {
      EXPECT_NEAR(frame.states[0].position.norm(), 1, 5e-15) << method << frame.time;
      EXPECT_NEAR((frame.states[1].position - frame.states[0].position).norm(), 1, 5e-15) << method << frame.time;
    }
  }
}

/// Largest error of the energy, which is 0 at the start, in any frame of two seconds.
double energyError(const std::string& method, double timeStep) {
  double largest = 0;
  for (const Frame& frame : swingTwo(methodText(method, timeStep), 2).frames)
    largest = std::max(largest, std::abs(energyConstantOf(frame)));
  return largest;
}

// Rods do no work, so what changes the energy is the integrator's doing alone, and goes away with its order. (RK4's
// energy is better by one order than its positions on an oscillator: z^6 / 72 a step.)
TEST(DoublePendulum, KeepsItsEnergyWithTheMethodsOrder) {
  for (const char* method : {"explicitEuler", "semiImplicitEuler"})
    EXPECT_NEAR(std::log2(energyError(method, 1.0 / 8192) / energyError(method, 1.0 / 16384)), 1, kOrderTolerance)
        << method;
  const double order = std::log2(energyError("rk4", 1.0 / 200) / energyError("rk4", 1.0 / 400));
  EXPECT_GT(order, 4 - kOrderTolerance);
  EXPECT_LT(order, 5 + kOrderTolerance);
}

}  // namespace
}  // namespace cradle
