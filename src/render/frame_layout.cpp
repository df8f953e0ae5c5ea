#include "render/frame_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/camera.h"
#include "render/instances.h"

namespace cradle {
namespace {

constexpr int kGreatestLevel = 3;     // 8 times as large as at home: shadows are hardly sharp enough
constexpr double kFarthest = 4096;    // quarters of a map from home: there, floats are an eighth of a texel apart
constexpr double kLargestCaster = 1;  // of the width of the shadow map's home
constexpr double kBorder = 10.0 / kShadowMapSize;  // of its size: the shadow map's edge stays clear, by whole blocks
constexpr double kPenumbra = 24;                   // texels beside a shadow that may be half lit

/// Half of space: where normal . (x - the camera) is positive.
using Side = Vec3;

/// The sides of what a camera sees, and all that is before it.
std::array<Side, 5> sidesOfView(const Camera& camera, const RenderSetup& setup) {
  const Mat3 axes = cameraAxes(camera);
  const double y = std::tan(camera.verticalFieldOfView / 2), x = y * setup.width / setup.height;
  const Vec3 right = axes.col(0), up = axes.col(1), ahead = -axes.col(2);
  return {(x * ahead - right).normalized(), (x * ahead + right).normalized(), (y * ahead - up).normalized(),
          (y * ahead + up).normalized(), ahead};
}

/// Collects what counts.
class LayoutFinder {
 public:
  LayoutFinder(const Camera& camera, const RenderSetup& setup)
      : setup_(setup), eye_(camera.position), towards_(setup.shadow.axes.col(2)), sides_(sidesOfView(camera, setup)) {}

  /// What is `distance` (m) from the camera, or farther.
  void add(const DrawnHull& hull, double distance);
  void add(const ContactShadowItem& item);
  FrameLayout layout() const;

 private:
  bool isBeyond(const Side& side, const DrawnHull& hull) const;
  bool isSeen(const DrawnHull& hull) const;
  bool mayThrowShadowIntoView(const DrawnHull& hull) const;
  void addToGround(const DrawnHull& hull);
  void extend(Box2& box, const Vec3& point, const Eigen::Vector2d& around) const;
  Box2 groundAround(const MapPlace& shadowMap) const;

  const RenderSetup& setup_;
  const Vec3 eye_, towards_;
  const std::array<Side, 5> sides_;
  double nearest_ = std::numeric_limits<double>::infinity();  // m
  Bounds casters_;                                            // m, along the shadow map's axes from the setup's origin
  Box2 shadows_, contactShadows_;                             // m, as ShadedRegion::home
};

bool LayoutFinder::isBeyond(const Side& side, const DrawnHull& hull) const {
  for (std::size_t i = 0; i < hull.count; ++i)
    if (side.dot(hull.centers[i] - eye_) + hull.radius >= 0) return false;
  return true;
}

bool LayoutFinder::isSeen(const DrawnHull& hull) const {
  return std::none_of(sides_.begin(), sides_.end(), [&](const Side& side) { return isBeyond(side, hull); });
}

/// Not if it is beyond a side of the view, and its shadow goes on from there.
bool LayoutFinder::mayThrowShadowIntoView(const DrawnHull& hull) const {
  return std::none_of(sides_.begin(), sides_.end(),
                      [&](const Side& side) { return side.dot(towards_) >= 0 && isBeyond(side, hull); });
}

void LayoutFinder::add(const DrawnHull& hull, double distance) {
  if (isSeen(hull)) nearest_ = std::min(nearest_, distance);
  if (2 * hull.reach() > kLargestCaster * setup_.shadow.home.sizes().x() || !mayThrowShadowIntoView(hull)) return;
  const double around = cornerOfEqualArea(kOutlines.front()) * hull.radius;
  for (std::size_t i = 0; i < hull.count; ++i) {
    const Vec3 place = setup_.shadow.axes.transpose() * (hull.centers[i] - setup_.origin);
    casters_.extend(Vec3(place.array() - around)), casters_.extend(Vec3(place.array() + around));
  }
  if (setup_.ground) addToGround(hull);
}

/// Its shadow on the ground.
void LayoutFinder::addToGround(const DrawnHull& hull) {
  const Ground& ground = *setup_.ground;
  const double steepness = ground.normal.dot(towards_);
  const auto heightOf = [&](const Vec3& point) { return ground.normal.dot(point - ground.point); };
  if (steepness <= kLowestLight || heightOf(hull.middle()) + hull.reach() < 0) return;
  const double around = hull.radius / steepness;
  for (std::size_t i = 0; i < hull.count; ++i)
    extend(shadows_, hull.centers[i] - heightOf(hull.centers[i]) / steepness * towards_, {around, around});
}

/// By a rectangle on the ground around a point.
void LayoutFinder::extend(Box2& box, const Vec3& point, const Eigen::Vector2d& around) const {
  const Vec3 from = point - setup_.origin;
  const Eigen::Vector2d place(setup_.shaded.axisU.dot(from), setup_.shaded.axisV.dot(from));
  box.extend(place - around), box.extend(place + around);
}

/// The ground that it darkens.
void LayoutFinder::add(const ContactShadowItem& item) {
  const auto square = darkenedSquare(item, setup_);
  const Vec3& middle = item.worldFromBox.translation;
  if (!square || 2 * item.half.norm() > kLargestCaster * setup_.shadow.home.sizes().x()) return;
  DrawnHull darkened;
  darkened.add(middle);
  darkened.radius = std::hypot(square->halfU, square->halfV) + item.half.norm();
  if (isSeen(darkened)) extend(contactShadows_, middle, {square->halfU, square->halfV});
}

/// Quarters of `size` from home, the fewest, so that a map there holds first..last (from the middle of home) and has
/// `border` (m) beside them; none if it is too small, or that would be too far.
std::optional<int> quartersFor(double first, double last, double size, double border) {
  const double half = size / 2 - border;
  const double most = std::floor((first + half) / (size / 4)), least = std::ceil((last - half) / (size / 4));
  const double quarters = std::clamp(0.0, std::min(least, most), most);
  if (!(least <= most) || std::abs(quarters) > kFarthest) return std::nullopt;
  return static_cast<int>(quarters);
}

FrameLayout LayoutFinder::layout() const {
  FrameLayout layout;
  // In powers of two, as all that must not change often.
  const double nearest = std::isfinite(nearest_) && nearest_ > 0 ? std::exp2(std::floor(std::log2(nearest_))) : 0;
  layout.nearPlane = nearPlaneFor(nearest, setup_);
  if (!casters_.isEmpty()) {
    layout.shadows = placeAround({casters_.min().head<2>(), casters_.max().head<2>()}, setup_.shadow.home, kBorder);
    const double deep = depthOfMap(setup_.shadow, layout.shadows);
    layout.depth = quartersFor(casters_.min().z(), casters_.max().z(), deep, kBorder * deep).value_or(0);
  }
  if (setup_.ground) layout.ground = placeAround(groundAround(layout.shadows), setup_.shaded.home, 0);
  return layout;
}

/// The part of the ground that shadows and contact shadows darken.
Box2 LayoutFinder::groundAround(const MapPlace& shadowMap) const {
  Box2 ground = contactShadows_;
  if (shadows_.isEmpty()) return ground;
  const double texel = std::ldexp(setup_.shadow.home.sizes().x(), shadowMap.level) / kShadowMapSize;
  const double halfLit = kPenumbra * texel / setup_.ground->normal.dot(towards_);
  const Eigen::Vector2d around(halfLit, halfLit);
  ground.extend(Box2(shadows_.min() - around, shadows_.max() + around));
  return ground;
}

}  // namespace

MapPlace placeAround(const Box2& needed, const Box2& home, double border) {
  if (needed.isEmpty()) return {};
  const Eigen::Vector2d first = needed.min() - home.center(), last = needed.max() - home.center();
  for (int level = 0; level <= kGreatestLevel; ++level) {
    const Eigen::Vector2d size = std::ldexp(1.0, level) * home.sizes();
    const auto x = quartersFor(first.x(), last.x(), size.x(), border * size.x()),
               y = quartersFor(first.y(), last.y(), size.y(), border * size.y());
    if (x && y) return {level, {*x, *y}};
  }
  return {kGreatestLevel, {}};
}

FrameLayout layoutOf(const DrawList& list, const std::vector<MeshBounds>& meshBounds, const Camera& camera,
                     const RenderSetup& setup) {
  LayoutFinder finder(camera, setup);
  for (const MeshItem& item : list.meshes) {
    const Bounds& whole = meshBounds[static_cast<std::size_t>(item.mesh)].whole;
    finder.add(hullOf(whole, item.worldFromMesh),
               whole.exteriorDistance(item.worldFromMesh.inverse() * camera.position));
  }
  const auto add = [&](const DrawnHull& hull) { finder.add(hull, hull.bounds().exteriorDistance(camera.position)); };
  for (const SphereItem& item : list.spheres) add(hullOf(item));
  for (const CylinderItem& item : list.cylinders) add(hullOf(item));
  for (const TubeItem& item : list.tubes) add(hullOf(item));
  if (setup.ground)
    for (const ContactShadowItem& item : list.contactShadows) finder.add(item);
  return finder.layout();
}

}  // namespace cradle
