// A body that starts inside another would be thrown out of it: the energy for that comes from nowhere. Contact needs a
// start that is possible.

#include "simulate/start_overlaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "collision/separation.h"
#include "core/error.h"

namespace cradle {
namespace {

constexpr double kTouchingPart = 1e-9;                                // of the smaller body's size
constexpr double kModelPart = std::numeric_limits<float>::epsilon();  // of a model's: its vertices are that exact
constexpr std::size_t kMostFaults = 50;

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
  return (isModel(a) || isModel(b) ? kModelPart : kTouchingPart) * std::min(sizeA, sizeB);
}

std::string lengthText(double meters) {
  return meters < 1 ? fmt::format("{:.4g} mm", 1000 * meters) : fmt::format("{:.4g} m", meters);
}

std::string faultOf(const Body& a, const Body& b, bool againstPlane, double depth, double allowed) {
  const std::string length = lengthText(depth);
  if (againstPlane)
    return fmt::format(
        "{}: \"{}\" is {} deep in the plane \"{}\" at the start; at most {} is touching; move it out "
        "along the plane's normal by {}, or give one of them \"collision\": \"none\"",
        a.where, a.name, length, b.name, lengthText(allowed), length);
  return fmt::format(
      "{}: \"{}\" and \"{}\" overlap by {} at the start; at most {} is touching; move them apart by {}, "
      "or give one of them \"collision\": \"none\"",
      b.where, a.name, b.name, length, lengthText(allowed), length);
}

/// Adds the overlaps of one island to `faults`.
void findOverlaps(const Scene& scene, const Assembly& assembly, std::vector<std::string>& faults) {
  const ContactGeometry& geometry = assembly.geometry;
  for (const ColliderPair& pair : geometry.pairs) {
    const auto [first, second] = bodiesOf(assembly, pair);
    const Body &a = scene.bodies[static_cast<std::size_t>(first)], &b = scene.bodies[static_cast<std::size_t>(second)];
    const RigidTransform worldFromA = poseOf(assembly.state, geometry.colliders[pair.a].body);
    if (separationBound(geometry, pair, worldFromA, poseOf(assembly.state, bodyBOf(geometry, pair))) > 0) continue;
    const double depth = depthOf(geometry, pair, assembly.state), allowed = touchingDepth(geometry, pair, a, b);
    if (depth > allowed) faults.push_back(faultOf(a, b, pair.againstPlane, depth, allowed));
  }
}

}  // namespace

void refuseStartOverlaps(const Scene& scene, const std::vector<Assembly>& islands) {
  std::vector<std::string> faults;
  for (const Assembly& assembly : islands) findOverlaps(scene, assembly, faults);
  if (faults.empty()) return;
  if (faults.size() > kMostFaults) {
    faults[kMostFaults] = fmt::format("and {} more", faults.size() - kMostFaults);
    faults.resize(kMostFaults + 1);
  }
  throw Error(ErrorKind::scene, "", fmt::format("{}", fmt::join(faults, "\n")));
}

}  // namespace cradle
