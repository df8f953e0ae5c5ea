// Active contacts with meshes. A sphere passes from one flat face, edge or corner to the next where its centre leaves
// the Voronoi region of the one (B. Mirtich, "V-Clip", 1998). That border is a root of a function of its own, found
// without gaps, so that a narrow region does not lie between two samples of the step. Bodies of other shapes touch the
// edges of meshes with their own edges, which rows do not keep: they have rows as long as they are over one flat face.

#include "simulate/events/contacts_on_meshes.h"

#include "collision/mesh_collider.h"
#include "collision/over_face.h"
#include "collision/root_bracketing.h"
#include "dynamics/integrators/pose_interpolant.h"
#include "simulate/rows_of_contacts.h"

namespace cradle {
namespace {

/// Bound (m) on how far the points of two bodies move relative to each other within a step, at a contact of theirs.
double motionAt(const Step& step, const Collider& a, const Collider& b) {
  const auto rotationOf = [&](const Collider& collider) {
    return collider.body == kFixed ? 0 : turnBounds(step, collider.body).speed * collider.boundingRadius;
  };
  return relativeMotionBounds(step, a.body, b.body).speed + rotationOf(a) + rotationOf(b);
}

}  // namespace

double insideVoronoiRegion(const Contact& contact, const SphereOverMesh& sphere) {
  return insideRegion(*sphere.mesh, touchedFeature(contact), sphere.center) + borderWidth(*sphere.mesh);
}

std::optional<FeatureChange> firstFeatureChange(const std::vector<ContactRecord>& records, const IslandState& island) {
  const ContactGeometry& geometry = island.assembly.geometry;
  const Step& step = island.step;
  std::optional<FeatureChange> first;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const ColliderPair& pair = records[i].pair;
    if (!sphereOverMesh(geometry, pair, step.startState).mesh) continue;
    const Collider &a = geometry.colliders[pair.a], &b = geometry.colliders[pair.b];
    const auto inside = [&](double fraction) {
      return insideVoronoiRegion(records[i].contact, sphereOverMesh(geometry, pair, poseAt(step, a.body, fraction),
                                                                    poseAt(step, b.body, fraction)));
    };
    GapBounds bounds;
    bounds.speed = motionAt(step, a, b);
    bounds.finest = kFinestBlindApproach;
    const double start = inside(0), until = first ? first->fraction : 1;
    const auto found =
        start > 0 ? firstRoot(inside, bounds, {0, start, until, inside(until)}) : std::optional<double>(kRootTolerance);
    if (found) first = FeatureChange{*found, i};
  }
  return first;
}

bool isServedOnMesh(const ContactRecord& record, double touchTolerance, const std::vector<BodyFrame>& frames,
                    const IslandState& island) {
  const ContactGeometry& geometry = island.assembly.geometry;
  const ColliderPair& pair = record.pair;
  if (pair.againstPlane) return true;
  const Collider &a = geometry.colliders[pair.a], &b = geometry.colliders[pair.b];
  if (!hasMesh(a, b) || a.isSphere() || b.isSphere()) return true;
  // A cylinder that rotates out of its position is told by tippingSpeed. A wall that it slides against is found by
  // the search for impacts of the points beside its active ones.
  if (a.kind() == ColliderKind::cylinder || b.kind() == ColliderKind::cylinder) return true;
  const OverFace over = overFace(geometry, pair, rowsOf(record.contact, island.state, frames).constraint, island.state);
  return over.solid && roomBeside(over, 2 * touchTolerance) > touchTolerance;
}

}  // namespace cradle
