// Rules of the plan. The first that applies to an island is taken:
//   1. the scene names a method: that one, for studies
//   2. spheres bounce without loss, and nothing acts but uniform gravity: closed form between collisions
//   3. many bodies of like density may touch, only gravity acts, no mesh that is not closed is among them, and the
//   accuracy asked is coarse: soft sub-stepping, whose overlaps would not tell the sides of a sheet apart
//   4. models with hollows may touch, and the accuracy asked is coarse: RK4 with a fixed step, active contact resolved
//   once a step, for their edges meet too often
//   5. nothing acts but uniform gravity: closed form
//   6. else DOP853 with steps as long as the accuracy allows; contact changes at events, and where bodies may touch and
//   the accuracy asked is coarse, DOPRI5 takes its place

#include "simulate/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/error.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/dormand_prince5.h"
#include "dynamics/integrators/explicit_euler.h"
#include "dynamics/integrators/rk4.h"
#include "dynamics/integrators/semi_implicit_euler.h"
#include "dynamics/rigid_body.h"
#include "mesh/solid.h"
#include "scene/named_accuracy.h"
#include "simulate/colliders.h"
#include "simulate/plan/plan_islands.h"
#include "simulate/spheres/hard_spheres.h"

namespace cradle {
namespace {

constexpr double kSoftTimeStep = 1.0 / 60;           // s, at most
constexpr std::size_t kMinSoftBodies = 50;           // with fewer, RK4 costs less than the pictures of its frames
constexpr double kMaxHeapRatio = 10;                 // of masses and of densities in a heap
constexpr std::size_t kMaxModelPoints = 30'000'000;  // some 700 MB
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSteppedTolerance = 1e-5;     // of the local error of RK4, at most: contact decides how good a step is
constexpr double kToleranceRatio = 0.02;       // of the accuracy: local errors of tens of steps add up, and take energy
constexpr double kCoarseToleranceRatio = 0.2;  // of the coarsest accuracy

/// Tolerance of the local error. The coarser the accuracy, the longer the steps, and DOP853's error estimate is too
/// high for long steps (docs/stability.md, accuracy).
double smoothTolerance(double accuracy) {
  return accuracy * std::max(kToleranceRatio, kCoarseToleranceRatio * accuracy / kCoarsestAccuracy);
}

ChosenMethod errorSteps(const Scene& scene) {
  return {MotionKind::errorSteps, "DOP853", 0, dop853, smoothTolerance(scene.accuracy), dop853Error, 8};
}

/// Where contact ends steps early, those of order 5 cost half, as they may end anywhere on their interpolant. Only at
/// coarse accuracies are they long enough.
ChosenMethod stepsToEvents(const Scene& scene) {
  if (scene.accuracy <= kVisualAccuracy) return errorSteps(scene);
  const double tolerance = kToleranceRatio * scene.accuracy;
  return {MotionKind::errorSteps, "DOPRI5", 0, dormandPrince5, tolerance, dormandPrince5Error, 5};
}

ChosenMethod namedMethod(const Scene& scene) {
  const double timeStep = scene.method->timeStep.value_or(kContactTimeStep);
  switch (scene.method->name) {
    case MethodName::explicitEuler:
      return {MotionKind::fixedSteps, "explicit Euler", timeStep, explicitEuler, 0, nullptr, 1};
    case MethodName::semiImplicitEuler:
      return {MotionKind::fixedSteps, "semi-implicit Euler", timeStep, semiImplicitEuler, 0, nullptr, 1};
    case MethodName::rk4:
      return {MotionKind::fixedSteps, "RK4", timeStep, rk4, 0, nullptr, 4};
    case MethodName::dop853:
      break;
  }
  if (scene.method->timeStep) return {MotionKind::fixedSteps, "DOP853", timeStep, dop853, 0, nullptr, 8};
  return errorSteps(scene);
}

/// Whether a link puts torques on its bodies wherever its anchors are.
bool holdsOrientations(LinkKind kind) {
  return kind == LinkKind::hinge || kind == LinkKind::slider || kind == LinkKind::weld;
}

bool isActedUpon(const IslandPlan& island) {
  return !island.links.empty() || !island.pushes.empty() || !island.driven.empty();
}

/// Finds spheres without torque: their angular velocity is constant, whatever moves their centres.
void findNonRotating(const Scene& scene, IslandPlan& island) {
  std::vector<char> hasTorque(island.bodies.size(), 0);
  const auto addTorque = [&](int body) {
    const auto found = std::lower_bound(island.bodies.begin(), island.bodies.end(), body);
    if (found != island.bodies.end() && *found == body)
      hasTorque[static_cast<std::size_t>(found - island.bodies.begin())] = 1;
  };
  for (const LinkIndex& link : island.links) {
    const auto [a, b] = anchorsOf(link, scene);
    for (const Anchor& anchor : {a, b}) {
      if (anchor.body == kWorld) continue;
      const Body& body = scene.bodies[static_cast<std::size_t>(anchor.body)];
      if (holdsOrientations(link.kind) || anchor.point != body.massProperties.centerOfMass) addTorque(anchor.body);
    }
  }
  for (const std::size_t push : island.pushes) addTorque(scene.pushes[push].body);
  for (const int body : island.touching) addTorque(body);
  for (std::size_t i = 0; i < island.bodies.size(); ++i)
    if (!hasTorque[i] &&
        makeRigidBody(scene.bodies[static_cast<std::size_t>(island.bodies[i])].massProperties).isSpherical)
      island.nonRotating.push_back(island.bodies[i]);
}

/// Whether a body that may touch has a mesh as its collider, neither a primitive nor a hull.
bool hasMesh(const Scene& scene, const IslandPlan& island) {
  return std::any_of(island.touching.begin(), island.touching.end(), [&](int body) {
    const auto collider = colliderOf(scene.bodies[static_cast<std::size_t>(body)], scene, kFixed);
    return collider && collider->kind() == ColliderKind::mesh;
  });
}

/// Whether a mesh that may be touched is not closed.
bool hasSheet(const Scene& scene, const IslandPlan& island) {
  return std::any_of(island.touching.begin(), island.touching.end(), [&](int index) {
    const Body& body = scene.bodies[static_cast<std::size_t>(index)];
    const auto collider = colliderOf(body, scene, kFixed);
    if (!collider || collider->kind() != ColliderKind::mesh) return false;
    const auto model = static_cast<std::size_t>(std::get<ModelShape>(body.shape).model);
    return !checkSolid(scene.models[model].solid).isClosed;
  });
}

/// Whether a body is much heavier and much denser than others: sweeps of soft sub-stepping do not carry a dense body on
/// a light one, but do carry large bodies among small ones of the same density (docs/stability.md, stacks).
bool hasDenseOnes(const Scene& scene, const IslandPlan& island) {
  const auto massOf = [&](int body) -> const MassProperties& {
    return scene.bodies[static_cast<std::size_t>(body)].massProperties;
  };
  const auto densityOf = [&](int body) {  // kg/m^3, times a number of the shape
    const double gyration = std::sqrt(massOf(body).inertiaTensor.trace() / massOf(body).mass);
    return massOf(body).mass / (gyration * gyration * gyration);
  };
  double lightest = kInfinity, thinnest = kInfinity;
  for (const int body : island.bodies)
    lightest = std::min(lightest, massOf(body).mass), thinnest = std::min(thinnest, densityOf(body));
  return std::any_of(island.bodies.begin(), island.bodies.end(), [&](int body) {
    return massOf(body).mass > kMaxHeapRatio * lightest && densityOf(body) > kMaxHeapRatio * thinnest;
  });
}

/// Whether hinges or sliders of an island have `part`: a motor, or limits.
template <class Part>
bool haveJoints(Part part, const Scene& scene, const IslandPlan& island) {
  return std::any_of(island.links.begin(), island.links.end(), [&](const LinkIndex& link) {
    if (link.kind == LinkKind::hinge) return part(scene.hinges[link.index]);
    return link.kind == LinkKind::slider && part(scene.sliders[link.index]);
  });
}

/// What limits, motors and driven bodies ask of the method, and leave of closed forms.
std::string reasonOfDrives(const Scene& scene, const IslandPlan& island) {
  const auto hasMotor = [](const auto& joint) { return joint.motor.has_value(); };
  const auto hasLimits = [](const auto& joint) { return joint.limits.has_value(); };
  std::string reason;
  if (island.method.isAdaptive() && haveJoints(hasMotor, scene, island))
    reason += "; they end where a motor comes to its velocity, or to the end of its force";
  if (island.method.isAdaptive() && haveJoints(hasLimits, scene, island))
    reason += "; a joint that comes to a limit is an event";
  if (!island.driven.empty())
    reason += "; driven bodies are where they are told, exactly, and leave no closed form to what they move";
  return reason;
}

void choose(const Scene& scene, IslandPlan& island) {
  findNonRotating(scene, island);
  if (!island.nonRotating.empty()) island.notNeeded.push_back("no rotation of balls held at their centres: no torque");
  const bool mayTouchSomething = !island.touching.empty();
  if (!mayTouchSomething) island.notNeeded.push_back("no search for contact: nothing can touch");
  if (scene.method) {
    island.method = namedMethod(scene);
    island.reason = "the scene names the method";
  } else if (mayTouchSomething && !scene.bumps && !isActedUpon(island) && hardSpheresOf(scene, island)) {
    island.method = {MotionKind::elasticFlight, "closed form between collisions"};
    island.reason = "elastic balls in flight: parabolas, and collisions in the order of time";
    island.notNeeded.push_back("no steps, no rotation: nothing turns balls that touch without friction");
  } else if (mayTouchSomething && scene.accuracy > kVisualAccuracy && island.bodies.size() >= kMinSoftBodies &&
             island.links.empty() && island.pushes.empty() && !hasDenseOnes(scene, island) &&
             !hasSheet(scene, island)) {
    island.method = {MotionKind::pile, "fast contact step", kSoftTimeStep};
    island.reason = "many bodies may touch: soft contacts, sub-stepped";
    island.notNeeded.push_back("no motion of bodies that lie still");
  } else if (mayTouchSomething && scene.accuracy > kVisualAccuracy && hasMesh(scene, island)) {
    island.method = contactSteps();
    if (hasSheet(scene, island))
      island.notNeeded.push_back("no soft contacts: a mesh that is not closed has two sides");
    island.reason = "models with hollows may touch: contact is resolved once a step";
  } else if (mayTouchSomething) {
    island.method = stepsToEvents(scene);
    island.reason = "something may touch: contact changes at events, with steps as long as the accuracy allows between";
  } else if (!isActedUpon(island)) {
    island.method = {MotionKind::freeFlight, "closed form"};
    island.reason = "nothing acts but uniform gravity: parabola and exact free rotation";
    island.notNeeded.push_back("no steps: one evaluation a frame");
  } else {
    island.method = errorSteps(scene);
    island.reason = "smooth forces: steps as long as the accuracy allows";
  }
  island.reason += reasonOfDrives(scene, island);
}

/// Throws Error(limit) if bodies of models that may touch have more points than fit into memory: each has its own.
void requireFewPoints(const Scene& scene, const std::vector<IslandPlan>& islands) {
  std::map<std::pair<int, CollisionChoice>, std::size_t> pointsOf;  // of a model's collider
  std::size_t points = 0;
  for (const IslandPlan& island : islands)
    for (const int index : island.touching) {
      const Body& body = scene.bodies[static_cast<std::size_t>(index)];
      const auto* shape = std::get_if<ModelShape>(&body.shape);
      if (!shape) continue;
      const auto [known, isNew] = pointsOf.emplace(std::pair(shape->model, body.collision), 0);
      const auto collider = isNew ? colliderOf(body, scene, kFixed) : std::nullopt;
      if (collider) known->second = collider->points.size();
      points += known->second;
      if (points > kMaxModelPoints)
        throw Error(ErrorKind::limit, body.where,
                    fmt::format("from here on, models of bodies that may touch have more than {} points in all; give "
                                "some \"collision\": \"hull\" or \"none\", or take simpler meshes or fewer bodies",
                                kMaxModelPoints));
    }
}

}  // namespace

ChosenMethod contactSteps(double timeStep) {
  return {MotionKind::fixedSteps, "RK4", timeStep, rk4, kSteppedTolerance, nullptr, 4};
}

Plan planOf(const Scene& scene) {
  const ReachablePairs reachable(scene);
  Plan plan{findIslands(scene, reachable), scene.accuracy};
  requireFewPoints(scene, plan.islands);
  for (IslandPlan& island : plan.islands) {
    choose(scene, island);
    island.promise = promiseOf(scene, island, reachable);
    island.method.keepsPromise = island.promise.kind == Promise::Kind::kept || island.promise.eventsServe;
  }
  return plan;
}

IslandPlan wholeScene(const Scene& scene) {
  IslandPlan whole;
  for (const IslandPlan& island : planOf(scene).islands) {
    whole.bodies.insert(whole.bodies.end(), island.bodies.begin(), island.bodies.end());
    whole.touching.insert(whole.touching.end(), island.touching.begin(), island.touching.end());
  }
  forEachLink(scene, [&](const LinkIndex& link, const Anchor&, const Anchor&) { whole.links.push_back(link); });
  for (std::size_t i = 0; i < scene.pushes.size(); ++i) whole.pushes.push_back(i);
  for (int body = 0; body < std::ssize(scene.bodies); ++body)
    if (scene.bodies[static_cast<std::size_t>(body)].motion == Motion::driven) whole.driven.push_back(body);
  for (std::vector<int>* bodies : {&whole.bodies, &whole.touching}) {
    std::sort(bodies->begin(), bodies->end());
    bodies->erase(std::unique(bodies->begin(), bodies->end()), bodies->end());
  }
  return whole;
}

}  // namespace cradle
