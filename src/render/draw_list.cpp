#include "render/draw_list.h"

#include <algorithm>

#include "render/body_place.h"
#include "render/link_items.h"
#include "render/push_arrows.h"

namespace cradle {
namespace {

constexpr std::size_t kMostNearBalls = 6;  // of one item: as many as touch a ball in a dense layer

void appendBody(const BodyAppearance& look, const RigidTransform& worldFromBody, DrawList& list) {
  for (const BodyPart& part : look.parts) {
    MeshItem item{part.mesh, part.firstTriangle, part.triangleCount, worldFromBody};
    item.surface = part.surface;
    item.isBall = look.ball.has_value();
    item.bounds = transformed(look.local, worldFromBody);
    list.meshes.push_back(item);
  }
}

void appendRound(const BodyAppearance& look, const RigidTransform& worldFromBody, int body, DrawList& list) {
  if (look.cylinder)
    list.cylinders.push_back({worldFromBody.translation, worldFromBody.rotation * Vec3::UnitY(), look.cylinder->radius,
                              look.cylinder->length, look.surface});
  if (!look.ball) return;
  const Vec3 center = worldFromBody * look.ball->center;
  list.balls.push_back({center, look.ball->radius, look.surface, body});
  if (look.isDrawnAsBall) list.spheres.push_back({center, look.ball->radius, look.surface});
}

void appendContact(const BodyAppearance& look, const RigidTransform& worldFromBody, DrawList& list) {
  if (look.local.isEmpty()) return;
  RigidTransform place = worldFromBody;
  place.translation = worldFromBody * Vec3(look.local.center());
  list.contacts.push_back({place, look.local.sizes() / 2, look.contact});
}

/// A plane other than the ground, as a square next to what is shown; from behind, it is not there.
void appendWall(const Scene& scene, const Appearance& appearance, const View& view, std::size_t body,
                const Vec3& viewpoint, DrawList& list) {
  const Plane* plane = std::get_if<Plane>(&scene.bodies[body].shape);
  if (plane == nullptr || (appearance.ground && appearance.ground->body == static_cast<int>(body))) return;
  const RigidTransform& place = scene.bodies[body].worldFromBody;
  const Vec3 normal = place.rotation * plane->normal;
  if (normal.dot(viewpoint - place.translation) <= 0) return;
  const DrawnMesh& mesh = appearance.meshes[static_cast<std::size_t>(appearance.wallMesh)];
  MeshItem item{appearance.wallMesh, 0, static_cast<std::uint32_t>(mesh.triangles.size())};
  const Vec3 middle = view.bounds.isEmpty() ? place.translation : Vec3(view.bounds.center());
  item.worldFromMesh = {Quat::FromTwoVectors(Vec3::UnitY(), normal),
                        middle - normal.dot(middle - place.translation) * normal};
  item.surface = appearance.bodies[body].surface;
  for (const Vec3& vertex : mesh.vertices) item.bounds.extend(item.worldFromMesh * vertex);
  list.walls.push_back(item);
}

Bounds boundsOf(const MeshItem& item) {
  return item.bounds;
}

template <typename RoundItem>
Bounds boundsOf(const RoundItem& item) {
  return item.bounds();
}

/// The balls near each item's bounds, the closest (in radii) first; not its own.
template <typename Item>
void findNearBalls(const std::vector<int>& bodyOfItem, std::vector<Item>& items, DrawList& list) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Bounds bounds = boundsOf(items[i]);
    std::vector<std::pair<double, int>> found;
    for (std::size_t b = 0; b < list.balls.size(); ++b) {
      const BallItem& ball = list.balls[b];
      const double distance = bounds.exteriorDistance(ball.center) / ball.radius;
      if (ball.body != bodyOfItem[i] && distance < kBallReach) found.emplace_back(distance, static_cast<int>(b));
    }
    const std::size_t count = std::min(found.size(), kMostNearBalls);
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), found.end());
    items[i].firstNearBall = static_cast<int>(list.nearBalls.size());
    items[i].nearBalls = static_cast<int>(count);
    for (std::size_t f = 0; f < count; ++f) list.nearBalls.push_back(found[f].second);
  }
}

}  // namespace

Bounds CylinderItem::bounds() const {
  // A disc across the axis reaches as far along each world axis as that axis lies in the disc.
  const Vec3 disc = (Vec3::Ones() - axis.cwiseProduct(axis)).cwiseMax(0).cwiseSqrt();
  const Vec3 half = radius * disc + length / 2 * axis.cwiseAbs();
  return {center - half, center + half};
}

DrawList makeDrawList(const Scene& scene, const Appearance& appearance, const View& view, const Frame& frame) {
  const auto places = placeBodies(scene, frame);
  DrawList list;
  std::vector<int> bodyOfMesh, bodyOfSphere, bodyOfCylinder;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const int body = static_cast<int>(i);
    appendBody(appearance.bodies[i], places[i], list);
    appendRound(appearance.bodies[i], places[i], body, list);
    appendContact(appearance.bodies[i], places[i], list);
    appendWall(scene, appearance, view, i, view.cameraAt(frame.number).position, list);
    bodyOfMesh.resize(list.meshes.size(), body);
    bodyOfSphere.resize(list.spheres.size(), body);
    bodyOfCylinder.resize(list.cylinders.size(), body);
  }
  findNearBalls(bodyOfMesh, list.meshes, list);
  findNearBalls(bodyOfSphere, list.spheres, list);
  findNearBalls(bodyOfCylinder, list.cylinders, list);
  appendLinks(scene, appearance, view, places, list);
  appendPushArrows(appearance, view, frame, places, list);
  std::stable_sort(list.meshes.begin(), list.meshes.end(), [](const MeshItem& a, const MeshItem& b) {
    return std::pair(a.mesh, a.firstTriangle) < std::pair(b.mesh, b.firstTriangle);
  });
  return list;
}

}  // namespace cradle
