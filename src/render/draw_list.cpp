#include "render/draw_list.h"

#include <algorithm>

#include "render/body_place.h"
#include "render/link_items.h"

namespace cradle {
namespace {

constexpr std::size_t kMostNearBalls = 6;  // of one item: as many as touch a ball in a dense layer
constexpr double kNear = 3;                // balls farther than so many of their radii do not matter

void appendBody(const BodyAppearance& look, const RigidTransform& worldFromBody, DrawList& list) {
  for (const BodyPart& part : look.parts) {
    MeshItem item{part.mesh, part.firstTriangle, part.triangleCount, worldFromBody};
    item.surface = part.surface;
    item.bounds = transformed(look.local, worldFromBody);
    list.meshes.push_back(item);
  }
}

void appendBall(const BodyAppearance& look, const RigidTransform& worldFromBody, int body, DrawList& list) {
  if (!look.ball) return;
  const Vec3 center = worldFromBody * look.ball->center;
  list.balls.push_back({center, look.ball->radius, look.ball->surface, body});
  if (look.isDrawnAsBall) list.spheres.push_back({center, look.ball->radius, look.ball->surface});
}

void appendContact(const BodyAppearance& look, const RigidTransform& worldFromBody, DrawList& list) {
  if (look.local.isEmpty()) return;
  RigidTransform place = worldFromBody;
  place.translation = worldFromBody * Vec3(look.local.center());
  list.contacts.push_back({place, look.local.sizes() / 2, look.ball.has_value()});
}

/// The balls near an item's bounds, the closest (in radii) first.
template <typename Item>
void findNearBalls(const std::vector<BallItem>& balls, const Bounds& bounds, int ownBody, Item& item,
                   std::vector<int>& nearBalls) {
  std::vector<std::pair<double, int>> found;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (balls[i].body == ownBody) continue;
    const double distance = bounds.exteriorDistance(balls[i].center) / balls[i].radius;
    if (distance < kNear) found.emplace_back(distance, static_cast<int>(i));
  }
  const std::size_t count = std::min(found.size(), kMostNearBalls);
  std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), found.end());
  item.firstNearBall = static_cast<int>(nearBalls.size());
  item.nearBalls = static_cast<int>(count);
  for (std::size_t i = 0; i < count; ++i) nearBalls.push_back(found[i].second);
}

}  // namespace

DrawList makeDrawList(const Scene& scene, const Appearance& appearance, const View& view, const Frame& frame) {
  const auto places = placeBodies(scene, frame);
  DrawList list;
  std::vector<int> bodyOfMesh, bodyOfSphere;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const BodyAppearance& look = appearance.bodies[i];
    appendBody(look, places[i], list);
    appendBall(look, places[i], static_cast<int>(i), list);
    appendContact(look, places[i], list);
    bodyOfMesh.resize(list.meshes.size(), static_cast<int>(i));
    bodyOfSphere.resize(list.spheres.size(), static_cast<int>(i));
  }
  for (std::size_t i = 0; i < list.meshes.size(); ++i)
    findNearBalls(list.balls, list.meshes[i].bounds, bodyOfMesh[i], list.meshes[i], list.nearBalls);
  for (std::size_t i = 0; i < list.spheres.size(); ++i)
    findNearBalls(list.balls, list.spheres[i].bounds(), bodyOfSphere[i], list.spheres[i], list.nearBalls);
  appendLinks(scene, appearance, view, places, list);
  std::stable_sort(list.meshes.begin(), list.meshes.end(), [](const MeshItem& a, const MeshItem& b) {
    return std::pair(a.mesh, a.firstTriangle) < std::pair(b.mesh, b.firstTriangle);
  });
  return list;
}

}  // namespace cradle
