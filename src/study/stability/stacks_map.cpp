// What the sweeps of sweeps_map.h come to: a solver that stops short leaves the boxes below a heavy one a part of its
// speed at each step, and they sink into each other until contacts push them out to the side.

#include "study/stability/stacks_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/error.h"
#include "simulate/simulate.h"
#include "simulate/soft_substeps.h"
#include "study/peers/peer.h"
#include "study/stability/contact_scenes.h"

namespace cradle {
namespace {

constexpr double kStands = 0.01, kFallen = 0.1;  // m, of boxes of 1 m: what is seen, and what is no stack any more

/// Box i, lowest first, belongs at i + 1/2 m above the ground.
template <class PositionOf>
double farthestOf(int boxes, const PositionOf& positionOf) {
  double farthest = 0;
  for (int i = 0; i < boxes; ++i) {
    const double distance = (positionOf(i) - (i + 0.5) * Vec3::UnitY()).norm();
    farthest = std::isfinite(distance) ? std::max(farthest, distance) : INFINITY;
  }
  return farthest;
}

using Stacker = std::function<double(int boxes, double topMass)>;

/// NaN where it stops with an error that says so.
double farthestOrError(const Stacker& stack, int boxes, double topMass) {
  try {
    return stack(boxes, topMass);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::unstable && error.kind() != ErrorKind::limit) throw;
    return NAN;
  }
}

double farthestInPeer(const Peer& peer, int boxes, double topMass) {
  const Scene scene = droppedStack(boxes, topMass);
  const Assembly assembly = assemble(scene, wholeScene(scene));
  VectorX state = assembly.state;
  const auto world = peer.open(scene, assembly, kUsualStep);
  world->advance(scene.duration);
  world->read(state);
  return farthestOf(boxes, [&](int box) { return Vec3(centerOfMass(state, box)); });
}

/// An engine that is compared, where the program was built with it.
struct StackingPeer {
  const char *name, *title;
};
constexpr std::array<StackingPeer, 4> kStackingPeers = {{{"bulletTuned", "Bullet, tuned"},
                                                         {"ode", "ODE, step"},
                                                         {"odeQuick", "ODE, quick step"},
                                                         {"mujocoTuned", "MuJoCo, implicit, stiff"}}};

std::vector<std::pair<std::string, Stacker>> stackers() {
  std::vector<std::pair<std::string, Stacker>> all = {{"cradle's contact step", farthestByContactStep},
                                                      {"cradle's fast contact step", farthestByPile}};
  for (const StackingPeer& way : kStackingPeers)
    for (const Peer& peer : peers())
      if (peer.name == way.name)
        all.emplace_back(way.title,
                         [&peer](int boxes, double topMass) { return farthestInPeer(peer, boxes, topMass); });
  return all;
}

}  // namespace

StackOutcome outcomeOf(double farthest) {
  if (std::isnan(farthest)) return StackOutcome::stopped;
  return farthest <= kStands ? StackOutcome::stands : farthest <= kFallen ? StackOutcome::leans : StackOutcome::fallen;
}

double farthestByContactStep(int boxes, double topMass) {
  Scene scene = droppedStack(boxes, topMass);
  scene.method = Method{MethodName::rk4, kUsualStep, "stability map"};
  scene.output.framesPerSecond = 1 / scene.duration;
  double farthest = 0;
  const auto take = [&](const Frame& frame) {
    farthest = farthestOf(boxes, [&](int box) { return frame.states[static_cast<std::size_t>(box)].position; });
  };
  simulate(scene, {take, [](const Event&) {}, [](const std::string&) {}});
  return farthest;
}

double farthestByPile(int boxes, double topMass) {
  const Scene scene = droppedStack(boxes, topMass);
  SoftSubsteps pile(assemble(scene, wholeScene(scene)), kUsualStep, 1);
  const VectorX& state = pile.stateAt(scene.duration);
  return farthestOf(boxes, [&](int box) { return Vec3(centerOfMass(state, box)); });
}

StabilityMap stacksMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "stacks";
  map.title = "Stacks of boxes with a heavy one on top: where they stand, 10 s after they were dropped";
  map.subtitle =
      "Boxes of 1 m and 1 kg fall onto each other by 1 cm each, friction 0.5; the topmost is heavier. All go by "
      "steps of 1/60 s.";
  map.paragraph =
      "Cradle's contact step solves all contacts of a step at once, to rounding, and stands at any mass. Solvers "
      "that sweep (Bullet, ODE's quick step, cradle's fast contact step) leave each box a part of its speed at "
      "every step: a top of ten to thirty times the mass makes its way through the rest. Cradle's fast contact step "
      "mostly ends with an error there rather than gain energy, and twice does not notice; the plan takes it for "
      "fifty bodies and more, if the accuracy asked is coarse and none is ten times as dense as others. ODE's direct "
      "step and MuJoCo's soft contacts hold some stacks and lose others next to them.";
  map.x = logarithmicAxis("mass of the topmost box / others", "", logarithmicallySpaced(1, 1e4, 9));
  map.y = linearAxis("boxes", "", {2, 4, 6, 8, 10, 12});
  map.outcomes = {{"stands to 1 cm", "#a9d3ee"},
                  {"leans, or has sunk, by up to 10 cm", "#f7dc8a"},
                  {"fallen", "#e79a7c"},
                  {"stopped with an error", "#c8c8c8"}};
  const auto all = stackers();
  for (const auto& [title, farthest] : all) {
    MapPanel& panel = map.panels.emplace_back(MapPanel{title, {}, {}});
    for (const double boxes : map.y.values) {
      for (const double mass : map.x.values)
        panel.cells.push_back(static_cast<double>(outcomeOf(farthestOrError(farthest, static_cast<int>(boxes), mass))));
      const double parts = static_cast<double>(all.size() * map.y.values.size());
      progress((static_cast<double>((map.panels.size() - 1) * map.y.values.size()) +
                static_cast<double>(panel.cells.size() / map.x.values.size())) /
               parts);
    }
  }
  return map;
}

}  // namespace cradle
