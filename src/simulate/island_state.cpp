#include "simulate/island_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.h"

namespace cradle {
namespace {

// Of a body that squeezes another. Rounding of its weight moves the other by 1e-16 g times this, and the equations of
// their contacts are as badly conditioned. Balls on balls come to rest with 9e8, and with 1e10 not all do; balls on
// boxes with 1e8 at accuracies of 1e-6 and 1e-8, and with 3e8 one of 90 runs did not end.
constexpr double kMaxMassRatio = 1e8;

}  // namespace

IslandState::IslandState(const Scene& source, Assembly parts)
    : lastStepEnd(source.duration),
      scene(source),
      assembly(std::move(parts)),
      equations(assembly.mechanism),
      rightHandSide(equations.rightHandSide()),
      log(assembly),
      resting(assembly.mechanism, assembly.geometry, equations),
      pushes(scene, assembly, log),
      bumps(scene, assembly),
      search(assembly.geometry),
      time(assembly.startTime),
      state(assembly.state),
      motions_(assembly.mechanism.bodies.size()),
      nextJump_(nextJump(assembly.mechanism.driven, time)) {
  assembly.mechanism.pushes = pushes.forces();
}

void IslandState::findNearPairs(double margin) {
  const ContactGeometry& geometry = assembly.geometry;
  if (geometry.colliders.size() + geometry.planes.size() == 2 && geometry.pairs.size() == 1) return;  // all there is
  for (std::size_t body = 0; body < motions_.size(); ++body)
    motions_[body] = motionBound(step, static_cast<int>(body), assembly.radii[body]);
  broadPhase_.update(step.startState, motions_, margin, assembly.geometry);
}

void IslandState::findNearPairsNow(double margin) {
  std::fill(motions_.begin(), motions_.end(), 0.0);
  broadPhase_.update(state, motions_, margin, assembly.geometry);
}

void IslandState::integrate(Integrator method, const VectorX& from, double length) {
  method(rightHandSide, from, time, length, step);
  place(assembly.mechanism.driven, step.time + step.timeStep, step.state);
}

bool IslandState::makeChanges() {
  if (time < nextChange()) return false;
  bool isAny = time >= pushes.nextChange();
  if (isAny)
    for (const int body : pushes.apply(time, state, assembly.mechanism.pushes)) wake(body);
  for (const DrivenBody& driven : assembly.mechanism.driven) {
    const bool rests = resting.isResting(driven.body);
    if (rests == isStill(driven.motion, time)) continue;
    if (rests) wake(driven.body);
    isAny = true;
  }
  nextJump_ = nextJump(assembly.mechanism.driven, time);
  return isAny;
}

void IslandState::wake(int body) {
  for (const int other : resting.wake(time, body))
    log.recordBody(time, EventKind::wake, other, centerOfMass(state, other));
}

void IslandState::failAtNoRoom(const Contact& contact) const {
  const auto [a, b] = bodiesOf(assembly, assembly.geometry.pairs[contact.pair]);
  const auto nameOf = [this](int body) { return scene.bodies[static_cast<std::size_t>(body)].name; };
  throw Error(ErrorKind::unstable, "",
              fmt::format("unstable at {:.6g} s: \"{}\" is pressed into \"{}\": what is driven leaves no room; keep it "
                          "farther off, or let a spring press in its place",
                          time, nameOf(a), nameOf(b)));
}

void IslandState::requireComparableMasses(const std::vector<Contact>& touching) const {
  const std::vector<RigidBody>& bodies = assembly.mechanism.bodies;
  const auto requireOf = [&](int heavy, int light) {
    if (heavy == kFixed || light == kFixed) return;
    const RigidBody &presses = bodies[static_cast<std::size_t>(heavy)],
                    &pressed = bodies[static_cast<std::size_t>(light)];
    if (presses.isDriven() || pressed.isDriven() || presses.mass <= kMaxMassRatio * pressed.mass) return;
    const bool isSqueezed = std::any_of(touching.begin(), touching.end(), [&](const Contact& other) {
      return (other.bodyA == light && other.bodyB != heavy) || (other.bodyB == light && other.bodyA != heavy);
    });
    if (!isSqueezed) return;
    const auto nameOf = [this](int body) {
      return scene.bodies[static_cast<std::size_t>(assembly.sceneBodies[static_cast<std::size_t>(body)])].name;
    };
    throw Error(ErrorKind::unstable, "",
                fmt::format("unstable at {0:.6g} s: \"{1}\" ({2:.3g} kg) squeezes \"{3}\" ({4:.3g} kg), and forces are "
                            "known to 1e-16 of the largest; make it no more than {5:.0e} times as heavy, or static",
                            time, nameOf(heavy), presses.mass, nameOf(light), pressed.mass, kMaxMassRatio));
  };
  for (const Contact& contact : touching) {
    requireOf(contact.bodyA, contact.bodyB);
    requireOf(contact.bodyB, contact.bodyA);
  }
}

void IslandState::requireUnsolvedPairsApart() const {
  for (const ColliderPair& pair : assembly.geometry.unsolvedPairs) {
    const int a = assembly.geometry.colliders[pair.a].body, b = bodyBOf(assembly.geometry, pair);
    if (separationBound(assembly.geometry, pair, poseOf(state, a), poseOf(state, b)) > 0) continue;
    const auto nameOf = [this](int body) {
      return scene.bodies[static_cast<std::size_t>(assembly.sceneBodies[static_cast<std::size_t>(body)])].name;
    };
    throw Error(ErrorKind::scene, scene.path,
                fmt::format("\"{}\" and \"{}\" come within reach of each other at {:.6g} s; their contact cannot be "
                            "simulated yet: keep them apart, or give one of them \"collision\": \"none\"",
                            nameOf(a), nameOf(b), time));
  }
}

}  // namespace cradle
