// Active contacts with meshes. A sphere passes from one flat face, edge or corner to the next where its centre leaves
// the space that is nearer to the one than to the other (its Voronoi region): that border is searched for without gaps,
// so that what is narrow does not lie between two looks. Bodies of other shapes touch the edges of meshes with their
// own edges, which rows do not keep: they stay on rows as long as all of them is over one flat face.

#include "collision/mesh_collider.h"
#include "collision/over_face.h"
#include "collision/root_bracketing.h"
#include "dynamics/integrators/pose_interpolant.h"
#include "simulate/events/active_contacts.h"

namespace cradle {
namespace {

/// Bound (m) on how far two bodies' points move relative to each other within a step, at a contact of theirs.
double motionAt(const Step& step, const Collider& a, const Collider& b) {
  const auto rotationOf = [&](const Collider& collider) {
    return collider.body == kFixed ? 0 : turnBounds(step, collider.body).speed * collider.boundingRadius;
  };
  return relativeMotionBounds(step, a.body, b.body).speed + rotationOf(a) + rotationOf(b);
}

}  // namespace

double ActiveContacts::insideBorder(const Contact& contact, const SphereOverMesh& sphere) {
  return insideRegion(*sphere.mesh, touchedFeature(contact), sphere.center) + borderWidth(*sphere.mesh);
}

std::optional<ContactChange> ActiveContacts::firstLeaving() const {
  const ContactGeometry& geometry = island_.assembly.geometry;
  const Step& step = island_.step;
  std::optional<ContactChange> first;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const ColliderPair& pair = records_[i].pair;
    if (!sphereOverMesh(geometry, pair, step.startState).mesh) continue;
    const Collider &a = geometry.colliders[pair.a], &b = geometry.colliders[pair.b];
    const auto inside = [&](double fraction) {
      return insideBorder(records_[i].contact, sphereOverMesh(geometry, pair, poseAt(step, a.body, fraction),
                                                              poseAt(step, b.body, fraction)));
    };
    GapBounds bounds;
    bounds.speed = motionAt(step, a, b);
    bounds.finest = kFinestBlindApproach;
    const double start = inside(0), until = first ? first->fraction : 1;
    if (start > bounds.speed) continue;
    const auto found =
        start > 0 ? firstRoot(inside, bounds, {0, start, until, inside(until)}) : std::optional<double>(kRootTolerance);
    if (found) first = ContactChange{ContactChange::Kind::leave, *found, i};
  }
  return first;
}

void ActiveContacts::noteMeshes(const std::vector<ContactRecord>& records) {
  const ContactGeometry& geometry = island_.assembly.geometry;
  for (const ContactRecord& record : records) {
    const ColliderPair& pair = record.pair;
    if (!record.isLoaded || pair.againstPlane || !canLast(record.contact)) continue;
    const Collider &a = geometry.colliders[pair.a], &b = geometry.colliders[pair.b];
    if (!hasMesh(a, b) || a.isSphere() || b.isSphere()) continue;
    // A cylinder that turns faults already (noteTipping); what it slides into is looked for beside what is held.
    if (a.kind() == ColliderKind::cylinder || b.kind() == ColliderKind::cylinder) continue;
    const OverFace over =
        overFace(geometry, pair, rowsOf(record.contact, island_.state, frames_).constraint, island_.state);
    if (!over.solid || roomBeside(over, 2 * reach_) <= reach_)
      noteFallback("a body moves over the edges of a mesh", {&record.contact});
  }
}

}  // namespace cradle
