#include "render/body_place.h"

#include "core/error.h"

namespace cradle {
namespace {

constexpr double kSteepestFloor = 0.3;  // y of the normal: a slope of 72 degrees

Bounds around(const Vec3& half) {
  return {-half, half};
}

struct BoundsOfShape {
  const Scene& scene;

  Bounds operator()(const Sphere& sphere) const { return around(Vec3::Constant(sphere.radius)); }
  Bounds operator()(const Box& box) const { return around(box.size / 2); }
  Bounds operator()(const Cylinder& c) const { return around({c.radius, c.length / 2, c.radius}); }
  Bounds operator()(const Capsule& c) const { return around({c.radius, c.length / 2 + c.radius, c.radius}); }
  Bounds operator()(const Plane&) const { return {}; }
  Bounds operator()(const ModelShape& shape) const {
    Bounds bounds;
    for (const Vec3& vertex : scene.models.at(static_cast<std::size_t>(shape.model)).drawn.vertices)
      bounds.extend(vertex);
    return bounds;
  }
};

}  // namespace

std::vector<RigidTransform> placeBodies(const Scene& scene, const Frame& frame) {
  std::vector<RigidTransform> places;
  places.reserve(scene.bodies.size());
  std::size_t next = 0;
  for (const Body& body : scene.bodies) {
    if (body.motion == Motion::fixed) {
      places.push_back(body.worldFromBody);
      continue;
    }
    const BodyState& state = frame.states.at(next++);
    places.push_back({state.orientation, state.position - state.orientation * body.massProperties.centerOfMass});
  }
  CRADLE_CHECK(next == frame.states.size());
  return places;
}

std::vector<RigidTransform> placeBodiesAtStart(const Scene& scene) {
  std::vector<RigidTransform> places;
  for (const Body& body : scene.bodies) places.push_back(body.worldFromBody);
  return places;
}

Bounds localBounds(const Scene& scene, const Body& body) {
  return std::visit(BoundsOfShape{scene}, body.shape);
}

bool isFloor(const Vec3& normal) {
  return normal.y() > kSteepestFloor;
}

Vec3 worldPoint(const Anchor& anchor, const std::vector<RigidTransform>& worldFromBody) {
  if (anchor.body == kWorld) return anchor.point;
  return worldFromBody.at(static_cast<std::size_t>(anchor.body)) * anchor.point;
}

Bounds transformed(const Bounds& local, const RigidTransform& worldFromLocal) {
  if (local.isEmpty()) return {};
  const Mat3 turn = worldFromLocal.rotation.toRotationMatrix();
  const Vec3 half = turn.cwiseAbs() * (local.sizes() / 2);
  const Vec3 center = worldFromLocal * Vec3(local.center());
  return {center - half, center + half};
}

}  // namespace cradle
