// Momentum goes down a stack, and up a chain, by one body a sweep, and light bodies carry little of it: M on m is left
// with M / (M + m) of its speed each time. A direct factorisation does not see the masses.

#include "study/stability/sweeps_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "constraints/constraint_forces.h"
#include "simulate/rows_of_contacts.h"
#include "simulate/steps/contact_stepping.h"
#include "study/stability/contact_scenes.h"

namespace cradle {
namespace {

constexpr double kFallTime = 1.0 / 60;                   // s, before all is to stop: a step at 60/s
constexpr double kStoppedRatio = 1e-3;                   // of the speed of the fall
constexpr long kMaxSweeps = 3000000;                     // beyond: no program waits so long
constexpr std::array<int, 4> kLengths = {2, 5, 10, 20};  // balls

double largestSpeed(const VectorX& state) {
  double largest = 0;
  for (Eigen::Index body = 0; body < bodyCount(state); ++body)
    largest = std::max(largest, linearVelocity(state, body).squaredNorm());
  return std::sqrt(largest);
}

/// The scene's bodies after a free fall that nothing has stopped yet.
StopProblem fallen(const Scene& scene, RowKind kind) {
  StopProblem problem{assemble(scene, wholeScene(scene)), {}, {}, kind};
  problem.state = problem.assembly.state;
  const Vec3 velocity = kFallTime * problem.assembly.mechanism.gravity;
  for (Eigen::Index body = 0; body < bodyCount(problem.state); ++body) {
    linearVelocity(problem.state, body) = velocity;
    centerOfMass(problem.state, body) += kFallTime * velocity;
  }
  return problem;
}

DirectSolution solveRods(const StopProblem& problem) {
  const Mechanism& mechanism = problem.assembly.mechanism;
  ConstraintSolver solver(mechanism.constraints, mechanism.bodies);
  VectorX state = problem.state;
  solver.factorize(problem.assembly.state);
  solver.constrainVelocities(state);
  return {1, largestSpeed(state)};
}

DirectSolution solveContacts(StopProblem problem) {
  const std::vector<Contact> contacts = contactsAtStart(problem.assembly);
  ContactStepping stepping(problem.assembly);
  VectorX state = problem.state;
  stepping.resolve(contacts, {}, problem.assembly.state, kFallTime, state);
  return {static_cast<double>(std::max(1L, stepping.iterations())), largestSpeed(state)};
}

}  // namespace

StopProblem stackToStop(int balls, double topMass) {
  StopProblem problem = fallen(stackOfBalls(balls, topMass), RowKind::pushes);
  std::vector<BodyFrame> frames;
  findBodyFrames(problem.assembly.mechanism.bodies, problem.assembly.state, frames);
  for (const Contact& contact : contactsAtStart(problem.assembly)) {
    const ContactRows rows = rowsOf(contact, problem.assembly.state, frames);
    findRows(rows.constraint, rows.place, false, problem.rows.emplace_back());
  }
  return problem;
}

StopProblem chainToStop(int balls, double bobMass) {
  StopProblem problem = fallen(hangingChain(balls, bobMass), RowKind::holds);
  std::vector<BodyFrame> frames;
  const Mechanism& mechanism = problem.assembly.mechanism;
  findBodyFrames(mechanism.bodies, problem.assembly.state, frames);
  for (const Constraint& rod : mechanism.constraints)
    findRows(rod, problem.assembly.state, frames, problem.rows.emplace_back());
  return problem;
}

SweepCount countSweeps(const StopProblem& problem) {
  GaussSeidel solver(problem.rows, problem.kind, problem.assembly.mechanism.bodies, problem.state);
  const double start = largestSpeed(problem.state);
  const double halfWay = std::sqrt(kStoppedRatio) * start;
  long halfSweeps = 0;
  double halfSpeed = start;
  for (long sweeps = 1; sweeps <= kMaxSweeps; ++sweeps) {
    solver.sweep();
    const double speed = largestSpeed(solver.state());
    if (speed <= kStoppedRatio * start)
      return {static_cast<double>(sweeps), std::pow(speed / halfSpeed, 1 / static_cast<double>(sweeps - halfSweeps))};
    if (speed > halfWay) halfSpeed = speed, halfSweeps = sweeps;
  }
  return {NAN, NAN};
}

DirectSolution solveDirectly(const StopProblem& problem) {
  return problem.kind == RowKind::holds ? solveRods(problem) : solveContacts(problem);
}

namespace {

MapPanel panelOf(const std::string& title, StopProblem (*problemOf)(int balls, double mass),
                 const MapProgress& progress) {
  const std::vector<double> ratios = logarithmicallySpaced(1, 1e4, 9);
  MapPanel panel{title, {}, {}};
  std::vector<MapCurve> theories;
  MapCurve direct{"cradle's solver, any number of balls", CurveKind::series, {}};
  for (const double ratio : ratios) direct.points.push_back({ratio, 0});
  for (const int length : kLengths) {
    MapCurve theory{"theory", CurveKind::theory, {}};
    MapCurve swept{fmt::format("{} balls", length), CurveKind::series, {}};
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      const StopProblem problem = problemOf(length, ratios[i]);
      const GaussSeidel solver(problem.rows, problem.kind, problem.assembly.mechanism.bodies, problem.state);
      theory.points.push_back({ratios[i], std::log(kStoppedRatio) / std::log(convergenceFactor(solver.matrix()))});
      swept.points.push_back({ratios[i], countSweeps(problem).sweeps});
      direct.points[i].y = std::max(direct.points[i].y, solveDirectly(problem).solves);
    }
    panel.curves.push_back(swept), theories.push_back(theory);
    progress(static_cast<double>(length) / kLengths.back());
  }
  panel.curves.push_back(direct);
  panel.curves.insert(panel.curves.end(), theories.begin(), theories.end());
  return panel;
}

}  // namespace

StabilityMap sweepsMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "sweeps";
  map.title = "A heavy body on light ones: sweeps of Gauss-Seidel until a thousandth of the speed is left";
  map.subtitle =
      "Balls of 1 kg, and one that is heavier, have fallen freely for 1/60 s and are to be stopped, all at once.";
  map.paragraph =
      "A stack of balls lands, or a chain of balls comes taut: all but one weigh 1 kg. Gauss-Seidel satisfies one "
      "contact or rod after the other, and hands momentum on by one ball a sweep: a mass M on a mass m is left with "
      "M / (M + m) of its speed, and each ball between them makes it worse. Sweeps are counted until nothing is "
      "faster than a thousandth of the fall; theory is ln(1/1000) / ln(largest eigenvalue of a sweep). Bullet takes "
      "10, ODE's quick step 20. Our own solvers (one factorisation of all rods, one cone problem of all contacts) "
      "do not depend on the masses.";
  map.x = logarithmicAxis("heaviest mass / others", "", {});
  map.y = logarithmicAxis("sweeps, or iterations", "", {});
  map.panels = {
      panelOf("stack, the heavy ball on top", stackToStop, [&](double part) { progress(part / 2); }),
      panelOf("hanging chain, the heavy ball lowest", chainToStop, [&](double part) { progress(0.5 + part / 2); })};
  return map;
}

}  // namespace cradle
