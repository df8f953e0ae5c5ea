#include "render/draw_list.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "math/rotation.h"
#include "render/body_place.h"
#include "render/link_items.h"
#include "render/motor_arrows.h"
#include "render/push_arrows.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxNearOccluders = 6;  // of one item: as many as touch a sphere in a dense layer
constexpr double kDistanceSteps =
    64;                       // of a reach: of those nearer to each other, rounding would choose anew in each frame
constexpr double kLarge = 4;  // times the typical occluder: compared with everything

void appendBody(const BodyAppearance& look, const RigidTransform& worldFromBody, DrawList& list) {
  for (const BodyPart& part : look.parts) {
    MeshItem item{part.mesh, part.firstTriangle, part.triangleCount, worldFromBody};
    item.surface = part.surface;
    item.isSphere = look.sphere.has_value();
    item.bounds = transformed(look.local, worldFromBody);
    list.meshes.push_back(item);
  }
}

void appendRound(const Appearance& appearance, const RigidTransform& worldFromBody, int body, DrawList& list) {
  const BodyAppearance& look = appearance.bodies[static_cast<std::size_t>(body)];
  if (look.cylinder)
    list.cylinders.push_back({worldFromBody.translation, worldFromBody.rotation * Vec3::UnitY(), look.cylinder->radius,
                              look.cylinder->length, look.surface, 0, 0, worldFromBody.rotation * Vec3::UnitX()});
  if (!look.sphere) return;
  const Vec3 center = worldFromBody * look.sphere->center;
  list.occluders.push_back({center, look.sphere->radius, inSmall(look.surface, appearance), body});
  if (look.isDrawnAsSphere)
    list.spheres.push_back({center, look.sphere->radius, look.surface, 0, 0, worldFromBody.rotation});
}

void appendSolids(const Appearance& appearance, const RigidTransform& worldFromBody, int body, DrawList& list) {
  const BodyAppearance& look = appearance.bodies[static_cast<std::size_t>(body)];
  for (const BodySolid& solid : look.solids) {
    const RigidTransform place{worldFromBody.rotation, worldFromBody * Vec3(solid.box.center())};
    const Vec3 half = solid.box.sizes() / 2;
    list.contactShadows.push_back({place, half, solid.kind});
    if (look.sphere || solid.kind == ContactShadowShape::ellipsoid) continue;
    const double middle = std::max(std::min(half.x(), half.y()), std::min(std::max(half.x(), half.y()), half.z()));
    list.occluders.push_back(
        {place.translation, kBoxReach * middle, inSmall(solid.surface, appearance), body, half, place.rotation});
  }
}

Bounds boundsOf(const MeshItem& item) {
  return item.bounds;
}

template <typename RoundItem>
Bounds boundsOf(const RoundItem& item) {
  return item.bounds();
}

/// Finds the occluders of a box in space: their reaches sorted along x, large ones apart.
class OccluderSearch {
 public:
  explicit OccluderSearch(const std::vector<OccluderItem>& occluders);

  /// Calls visit(index) for all whose reach meets `bounds`, and perhaps others. O(log n + those beside in x).
  template <typename Visit>
  void forNear(const Bounds& bounds, const Visit& visit) const;

 private:
  struct Entry {
    double least;  // m, along x
    int index;
  };
  std::vector<Entry> sorted_;
  std::vector<int> large_;
  double widest_ = 0;  // m, of those sorted
};

OccluderSearch::OccluderSearch(const std::vector<OccluderItem>& occluders) {
  std::vector<double> widths;
  for (const OccluderItem& item : occluders) widths.push_back(item.reach().sizes().x());
  std::vector<double> ordered = widths;
  if (ordered.empty()) return;
  std::nth_element(ordered.begin(), ordered.begin() + std::ssize(ordered) / 2, ordered.end());
  const double limit = kLarge * ordered[ordered.size() / 2];
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const int index = static_cast<int>(i);
    if (widths[i] > limit) {
      large_.push_back(index);
      continue;
    }
    sorted_.push_back({occluders[i].reach().min().x(), index});
    widest_ = std::max(widest_, widths[i]);
  }
  std::stable_sort(sorted_.begin(), sorted_.end(), [](const Entry& a, const Entry& b) { return a.least < b.least; });
}

template <typename Visit>
void OccluderSearch::forNear(const Bounds& bounds, const Visit& visit) const {
  for (const int index : large_) visit(index);
  const auto first = std::lower_bound(sorted_.begin(), sorted_.end(), bounds.min().x() - widest_,
                                      [](const Entry& entry, double place) { return entry.least < place; });
  for (auto entry = first; entry != sorted_.end() && entry->least <= bounds.max().x(); ++entry) visit(entry->index);
}

/// Distance of an occluder from a box in space, in terms of how far it reaches: below 1, it counts.
double relativeDistance(const OccluderItem& item, const Bounds& bounds) {
  if (item.isSphere()) return bounds.exteriorDistance(item.center) / (kSphereReach * item.radius);
  const Vec3 extent = item.rotation.toRotationMatrix().cwiseAbs() * item.half;
  return bounds.exteriorDistance(Bounds(item.center - extent, item.center + extent)) / item.radius;
}

/// The occluders of each item's bounds, the closest first, to kDistanceSteps; not its own.
template <typename Item>
void findNearOccluders(const std::vector<int>& bodyOfItem, const OccluderSearch& search, std::vector<Item>& items,
                       DrawList& list) {
  std::vector<std::pair<double, int>> found;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Bounds bounds = boundsOf(items[i]);
    found.clear();
    search.forNear(bounds, [&](int index) {
      const OccluderItem& item = list.occluders[static_cast<std::size_t>(index)];
      if (item.body == bodyOfItem[i]) return;
      const double distance = relativeDistance(item, bounds);
      if (distance < 1) found.emplace_back(std::floor(kDistanceSteps * distance), index);
    });
    const std::size_t count = std::min(found.size(), kMaxNearOccluders);
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), found.end());
    items[i].firstNearOccluder = static_cast<int>(list.nearOccluders.size());
    items[i].nearOccluders = static_cast<int>(count);
    for (std::size_t f = 0; f < count; ++f) list.nearOccluders.push_back(found[f].second);
  }
}

}  // namespace

Bounds CylinderItem::bounds() const {
  // A disc across the axis reaches as far along each world axis as that axis lies in the disc.
  const Vec3 disc = (Vec3::Ones() - axis.cwiseProduct(axis)).cwiseMax(0).cwiseSqrt();
  const Vec3 half = radius * disc + length / 2 * axis.cwiseAbs();
  return {center - half, center + half};
}

Bounds OccluderItem::reach() const {
  const Vec3 extent = isSphere() ? Vec3::Constant(kSphereReach * radius)
                                 : Vec3(rotation.toRotationMatrix().cwiseAbs() * half + Vec3::Constant(radius));
  return {center - extent, center + extent};
}

std::optional<MeshItem> wallOf(const Scene& scene, const Appearance& appearance, const View& view, std::size_t body,
                               const Vec3& viewpoint) {
  const Plane* plane = std::get_if<Plane>(&scene.bodies[body].shape);
  if (plane == nullptr || (appearance.ground && appearance.ground->body == static_cast<int>(body))) return std::nullopt;
  const RigidTransform& place = scene.bodies[body].worldFromBody;
  const Vec3 normal = place.rotation * plane->normal;
  if (normal.dot(viewpoint - place.translation) <= 0) return std::nullopt;
  const DrawnMesh& mesh = appearance.meshes[static_cast<std::size_t>(appearance.wallMesh)];
  MeshItem item{appearance.wallMesh, 0, static_cast<std::uint32_t>(mesh.triangles.size())};
  const Vec3 middle = view.bounds.isEmpty() ? place.translation : Vec3(view.bounds.center());
  item.worldFromMesh = {rotationBetween(Vec3::UnitY(), normal),
                        middle - normal.dot(middle - place.translation) * normal};
  item.surface = appearance.bodies[body].surface;
  for (const Vec3& vertex : mesh.vertices) item.bounds.extend(item.worldFromMesh * vertex);
  return item;
}

DrawList makeDrawList(const Scene& scene, const Appearance& appearance, const View& view, const SeenFrame& seen) {
  const auto places = placeBodies(scene, seen.frame);
  DrawList list;
  std::vector<int> bodyOfMesh, bodyOfSphere, bodyOfCylinder;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const int body = static_cast<int>(i);
    appendBody(appearance.bodies[i], places[i], list);
    appendRound(appearance, places[i], body, list);
    appendSolids(appearance, places[i], body, list);
    if (const auto wall = wallOf(scene, appearance, view, i, seen.viewpoint)) list.walls.push_back(*wall);
    bodyOfMesh.resize(list.meshes.size(), body);
    bodyOfSphere.resize(list.spheres.size(), body);
    bodyOfCylinder.resize(list.cylinders.size(), body);
  }
  const OccluderSearch search(list.occluders);
  findNearOccluders(bodyOfMesh, search, list.meshes, list);
  findNearOccluders(bodyOfSphere, search, list.spheres, list);
  findNearOccluders(bodyOfCylinder, search, list.cylinders, list);
  appendLinks(scene, appearance, view, places, list);
  appendPushArrows(appearance, view, seen.frame, places, list);
  appendMotorArrows(scene, appearance, seen.frame, places, list);
  std::stable_sort(list.meshes.begin(), list.meshes.end(), [](const MeshItem& a, const MeshItem& b) {
    return std::tuple(a.mesh, a.firstTriangle, a.surface.texture) <
           std::tuple(b.mesh, b.firstTriangle, b.surface.texture);
  });
  return list;
}

}  // namespace cradle
