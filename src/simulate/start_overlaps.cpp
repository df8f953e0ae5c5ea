// A body that starts inside another would be thrown out of it: the energy for that comes from nowhere. Bodies that
// overlap little are moved apart before the run begins; a deep overlap is a mistake in the scene.

#include "simulate/start_overlaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "collision/broad_phase.h"
#include "collision/mesh_surface.h"
#include "collision/separation.h"
#include "core/error.h"
#include "impact/overlap.h"

namespace cradle {
namespace {

constexpr double kPassedLimit = 1e-9;                                  // of the size: less is rounding
constexpr double kTouchingRatio = 1e-9;                                // of the smaller body's size
constexpr double kModelRatio = std::numeric_limits<float>::epsilon();  // of a model's: its vertices are that exact
constexpr double kMaxOverlapRatio = 0.5;                               // of the smaller body's inner radius
constexpr int kMaxPushRounds = 20;  // of moving apart: each may bring others together
// Pairs that are moved apart, each counted in each round: some seconds, and for a few thousand pairs all rounds.
constexpr double kMaxPushes = 50'000;
constexpr double kBodiesOfAPush = 10;  // whose constraints take as long as a pair without any

/// The deepest overlap (m) of a pair; < 0 or -infinity if it has none.
double depthOf(const ContactGeometry& geometry, const ColliderPair& pair, const VectorX& state) {
  std::vector<std::size_t> features;
  appendFeaturesWithin(geometry, pair, poseOf(state, geometry.colliders[pair.a].body), 0, features);
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t feature : features) least = std::min(least, separation(geometry, pair, feature, state));
  return -least;
}

bool isModel(const Body& body) {
  return std::holds_alternative<ModelShape>(body.shape);
}

/// How deep (m) a pair may overlap and still count as touching.
double touchingDepth(const ContactGeometry& geometry, const ColliderPair& pair, const Body& a, const Body& b) {
  const double sizeA = geometry.colliders[pair.a].boundingRadius;
  const double sizeB = pair.againstPlane ? sizeA : geometry.colliders[pair.b].boundingRadius;
  return (isModel(a) || isModel(b) ? kModelRatio : kTouchingRatio) * std::min(sizeA, sizeB);
}

std::string lengthText(double meters) {
  return meters < 1 ? fmt::format("{:.4g} mm", 1000 * meters) : fmt::format("{:.4g} m", meters);
}

/// How deep (m) a pair may overlap to be moved apart.
double correctableDepth(const ContactGeometry& geometry, const ColliderPair& pair) {
  const double radiusA = innerRadius(geometry.colliders[pair.a]);
  return kMaxOverlapRatio * (pair.againstPlane ? radiusA : std::min(radiusA, innerRadius(geometry.colliders[pair.b])));
}

/// Two bodies of an island that overlap.
struct StartOverlap {
  const Body &a, &b;
  bool againstPlane, isThroughSheet;
  double depth, correctable;  // m
};

std::string textOf(const StartOverlap& overlap) {
  const auto& [a, b, againstPlane, isThroughSheet, depth, correctable] = overlap;
  if (againstPlane)
    return fmt::format("{}: \"{}\" is {} deep in the plane \"{}\" at the start", a.where, a.name, lengthText(depth),
                       b.name);
  return fmt::format("{}: \"{}\" and \"{}\" overlap by {} at the start", b.where, a.name, b.name, lengthText(depth));
}

bool isSheet(const ContactGeometry& geometry, std::size_t collider) {
  const Collider& mesh = geometry.colliders[collider];
  return mesh.kind() == ColliderKind::mesh && mesh.mesh && mesh.mesh->isSheet;
}

std::string faultOf(const StartOverlap& overlap) {
  if (overlap.isThroughSheet)
    return fmt::format(
        "{}; one of them is a mesh that is not closed, a sheet with two sides, and the other has to be on one of them; "
        "at most {}, half of the radius inside it, is mended; move it by {} to the side of its middle, or give one of "
        "them "
        "\"collision\": \"none\"",
        textOf(overlap), lengthText(overlap.correctable), lengthText(overlap.depth));
  return fmt::format(
      "{}; at most {}, half of the radius inside the smaller one, is mended; move {} by {}, or give one "
      "of them \"collision\": \"none\"",
      textOf(overlap), lengthText(overlap.correctable),
      overlap.againstPlane ? "it out along the plane's normal" : "them apart", lengthText(overlap.depth));
}

bool isCorrectable(const StartOverlap& overlap) {
  return overlap.depth <= overlap.correctable;
}

/// All overlaps of an island, or those found up to the first `maxFaults` that are not correctable.
std::vector<StartOverlap> overlapsOf(const Scene& scene, const Assembly& assembly, std::size_t maxFaults) {
  const ContactGeometry& geometry = assembly.geometry;
  std::vector<StartOverlap> overlaps;
  std::size_t faults = 0;
  for (const ColliderPair& pair : geometry.pairs) {
    const auto [first, second] = bodiesOf(assembly, pair);
    const Body &a = scene.bodies[static_cast<std::size_t>(first)], &b = scene.bodies[static_cast<std::size_t>(second)];
    const RigidTransform worldFromA = poseOf(assembly.state, geometry.colliders[pair.a].body);
    if (separationBound(geometry, pair, worldFromA, poseOf(assembly.state, bodyBOf(geometry, pair))) > 0) continue;
    const double depth = depthOf(geometry, pair, assembly.state);
    if (depth <= touchingDepth(geometry, pair, a, b)) continue;
    const bool isThroughSheet = !pair.againstPlane && (isSheet(geometry, pair.a) || isSheet(geometry, pair.b));
    overlaps.push_back({a, b, pair.againstPlane, isThroughSheet, depth, correctableDepth(geometry, pair)});
    if (!isCorrectable(overlaps.back()) && ++faults == maxFaults) break;
  }
  return overlaps;
}

/// The bodies with an infinite inertia where they have no constraints: an overlap says how far bodies are to be moved,
/// but not how they are to be turned, and what was put straight is to stay straight. Constraints leave some bodies no
/// other way.
std::vector<RigidBody> bodiesThatKeepUpright(const Mechanism& mechanism) {
  std::vector<RigidBody> bodies = mechanism.bodies;
  for (RigidBody& body : bodies) body.inverseInertia.setZero();
  const auto free = [&](int body) {
    const std::size_t index = static_cast<std::size_t>(body);
    if (body != kFixed) bodies[index].inverseInertia = mechanism.bodies[index].inverseInertia;
  };
  for (const Constraint& constraint : mechanism.constraints)
    free(constraint.anchorA.body), free(constraint.anchorB.body);
  return bodies;
}

void moveApart(Assembly& assembly) {
  const std::vector<RigidBody> bodies = bodiesThatKeepUpright(assembly.mechanism);
  ConstraintSolver solver(assembly.mechanism.constraints, assembly.mechanism.bodies);
  if (solver.hasConstraints()) solver.factorize(assembly.state);
  std::vector<Contact> contacts;
  findContacts(assembly.geometry, assembly.state, 0, contacts);
  resolveOverlaps(assembly.geometry, contacts, ImpulseResponse(bodies, solver), assembly.state);
  if (solver.hasConstraints()) solver.project(assembly.state);
  // What was moved may be near others now.
  BroadPhase().update(assembly.state, std::vector<double>(assembly.mechanism.bodies.size(), 0.0), 0, assembly.geometry);
}

/// The work of a round of moving apart, in pairs without constraints.
double pushesOfARound(const Assembly& assembly, std::size_t overlaps) {
  const Mechanism& mechanism = assembly.mechanism;
  const double bodies = mechanism.constraints.empty() ? 0 : static_cast<double>(mechanism.bodies.size());
  return static_cast<double>(overlaps) * (1 + bodies / kBodiesOfAPush);
}

/// Adds a fault for each overlap, up to kMaxFaultsCounted in all.
void addFaults(const std::vector<StartOverlap>& overlaps, const char* why, std::vector<std::string>& faults) {
  for (const StartOverlap& overlap : overlaps) {
    if (faults.size() == kMaxFaultsCounted) return;
    faults.push_back(faults.size() < kMaxFaultsTold ? textOf(overlap) + why : "");
  }
}

/// Whether a rope is longer than it may be, or a joint beyond its stop.
bool isPassed(const Limit& limit, const VectorX& state) {
  return motionOf(limit, state).slackLength < -kPassedLimit * sizeOf(limit);
}

/// Adds a fault for each limit that bodies have come beyond that were moved apart; `before` are those that were passed
/// then, which are other faults.
void addPassedLimits(const Scene& scene, const Assembly& assembly, const std::vector<bool>& before,
                     std::vector<std::string>& faults) {
  for (std::size_t i = 0; i < assembly.limits.size() && faults.size() < kMaxFaultsTold; ++i) {
    if (before[i] || !isPassed(assembly.limits[i], assembly.state)) continue;
    const auto [a, b] = assembly.limitBodies[i];
    const bool isRope = std::holds_alternative<RopeLimit>(assembly.limits[i]);
    const Body& body = scene.bodies[static_cast<std::size_t>(a != kWorld ? a : b)];
    faults.push_back(
        fmt::format("{}: \"{}\" overlaps what it touches at the start, or is moved by what does, and moving it out "
                    "brings it beyond "
                    "{}; mend its place in the scene, or {}",
                    body.where, body.name, isRope ? "the length of its rope" : "a limit of its joint",
                    isRope ? "make the rope longer" : "widen the limit"));
  }
}

/// Moves bodies apart until none overlaps, each round of as many pairs as `overlaps`; what is left is a fault.
void moveAllApart(const Scene& scene, const std::vector<StartOverlap>& overlaps, Assembly& assembly,
                  std::vector<std::string>& faults) {
  const double pushes = pushesOfARound(assembly, overlaps.size());
  if (pushes > kMaxPushes)
    return addFaults(overlaps, "; more pairs overlap than are moved apart: mend their places in the scene", faults);
  const double rounds = std::min<double>(kMaxPushRounds, kMaxPushes / pushes);
  std::vector<bool> passed;
  for (const Limit& limit : assembly.limits) passed.push_back(isPassed(limit, assembly.state));
  std::vector<StartOverlap> left = overlaps;
  for (int round = 0; round < rounds && !left.empty(); ++round) {
    moveApart(assembly);
    left = overlapsOf(scene, assembly, kMaxFaultsCounted);
  }
  // Told is how deep they were before they were pushed.
  for (StartOverlap& overlap : left)
    for (const StartOverlap& before : overlaps)
      if (&before.a == &overlap.a && &before.b == &overlap.b) overlap.depth = before.depth;
  addFaults(left,
            ", and what is around holds them together: mend their places in the scene, or those of what ties and "
            "supports them",
            faults);
  if (left.empty()) addPassedLimits(scene, assembly, passed, faults);
  for (const StartOverlap& overlap : overlaps)
    assembly.warnings.push_back(textOf(overlap) + "; they were moved apart before the run");
}

/// Moves bodies apart whose overlaps are correctable; the others are faults.
void correctPenetrations(const Scene& scene, Assembly& assembly, std::vector<std::string>& faults) {
  const std::vector<StartOverlap> overlaps = overlapsOf(scene, assembly, kMaxFaultsCounted - faults.size());
  const std::size_t before = faults.size();
  for (const StartOverlap& overlap : overlaps)
    if (!isCorrectable(overlap)) faults.push_back(faults.size() < kMaxFaultsTold ? faultOf(overlap) : "");
  if (!overlaps.empty() && faults.size() == before) moveAllApart(scene, overlaps, assembly, faults);
}

}  // namespace

std::vector<std::pair<int, int>> bodiesInEachOther(const Scene& scene) {
  std::vector<std::pair<int, int>> pairs;
  const Body* const first = scene.bodies.data();
  for (const IslandPlan& island : planOf(scene).islands) {
    if (island.touching.empty()) continue;
    for (const StartOverlap& overlap : overlapsOf(scene, assemble(scene, island), kMaxFaultsCounted))
      pairs.emplace_back(static_cast<int>(&overlap.a - first), static_cast<int>(&overlap.b - first));
  }
  return pairs;
}

void correctStartPenetrations(const Scene& scene, std::vector<Assembly>& islands) {
  std::vector<std::string> faults;
  for (Assembly& assembly : islands)
    if (faults.size() < kMaxFaultsCounted) correctPenetrations(scene, assembly, faults);
  refuse(faults);
}

}  // namespace cradle
