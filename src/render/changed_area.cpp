// What changes where something moves: its own pixels; its shadow on whatever stands behind it in the light; the sky's
// light and the mirror images that a ball takes from and gives to what is near it; the darkened ground beneath it; and
// all balls that mirror the ground with its shadows. Old and new place count alike.

#include "render/changed_area.h"

#include <algorithm>
#include <cmath>

#include "render/instances.h"
#include "render/shadow_casters.h"

namespace cradle {
namespace {

constexpr double kWholeFrom = 0.6;  // of the picture: from there on, drawing all of it costs less than finding out
// As in shadow.glsl: the disc over which shadows are looked up, what it is widened by (look-ups between texels, and
// beside the surface), and what whole blocks add where its size is found out; texels of the shadow map.
constexpr double kLightRadius = 0.03, kWidestRadius = 16, kAroundDisc = 6, kAroundBlocks = 20;
constexpr double kBlurredTexels = 12;  // as in environment.glsl
constexpr double kLeastTurn = 0.5;     // of a ball's normal from pixel to pixel: a mesh turns by facets
constexpr double kEdgePixels = 32;
constexpr double kContactTexels = 2;  // of the contact map, which is interpolated

/// Alike for OpenGL, which computes in single precision; balls near them apart.
template <typename Item>
bool isSame(const Item& a, const Item& b, const Stage& stage) {
  Instance first = instanceOf(a, stage), second = instanceOf(b, stage);
  for (const std::size_t number : kNearBallNumbers) first[number] = second[number] = 0;
  if constexpr (std::is_same_v<Item, MeshItem>)
    if (a.mesh != b.mesh || a.firstTriangle != b.firstTriangle || a.triangleCount != b.triangleCount) return false;
  if constexpr (std::is_same_v<Item, SphereItem> || std::is_same_v<Item, CylinderItem>)
    if (outlineLevel(a, stage) != outlineLevel(b, stage)) return false;
  return first == second;
}

bool isSame(const NeighbourItem& a, const NeighbourItem& b, const Stage& stage) {
  return numbersOf(a, stage) == numbersOf(b, stage);
}

bool isSame(const ContactItem& a, const ContactItem& b, const Stage& stage) {
  const auto first = darkenedSquare(a, stage), second = darkenedSquare(b, stage);
  if (!first || !second) return !first && !second;
  return instanceOf(a, *first, stage) == instanceOf(b, *second, stage);
}

/// Size of a pixel at distance 1, in the middle of the picture.
double pixelAngle(const Stage& stage) {
  return 2 * std::tan(stage.camera.verticalFieldOfView / 2) / stage.height;
}

/// Collects the area; once it is nearly everything, it is everything.
class ChangeFinder {
 public:
  ChangeFinder(const DrawList& before, const DrawList& now, const Stage& stage,
               const std::vector<MeshBounds>& meshBounds)
      : before_(before),
        now_(now),
        stage_(stage),
        meshBounds_(meshBounds),
        area_{{stage.width, stage.height}, {}, false} {}

  ChangedArea find();

 private:
  /// Something that is drawn as before, or a part of it.
  struct Receiver {
    TileSpans spans;
    Bounds bounds;  // m, world
  };

  DrawnHull hull(const MeshItem& item) const {
    return hullOf(meshBounds_[static_cast<std::size_t>(item.mesh)].whole, item.worldFromMesh);
  }
  template <typename Item>
  DrawnHull hull(const Item& item) const {
    return hullOf(item);
  }

  TileSpans spansOf(const DrawnHull& hull);
  template <typename Item>
  void compareItems(const std::vector<Item>& before, const std::vector<Item>& now, bool throwsShadow);
  template <typename Item>
  void addReceivers(const Item& item);
  void addReceiver(const DrawnHull& hull);
  template <typename Item>
  void compareNearBalls(const Item& before, const Item& now, std::size_t first);
  void addAround(const NeighbourItem& item, std::size_t first);
  void compareContacts();
  void addDarkened(const ContactItem& item);
  void addCommon(const TileSpans& item, const DrawnHull& hull);
  void addShadowOnGround(const DrawnHull& caster);
  void addShadowOnItems(const DrawnHull& caster);
  void addMirrors(const Surface& surface, const DrawnHull& ball);
  double shadowMargin(double distance) const;

  const DrawList &before_, &now_;
  const Stage& stage_;
  const std::vector<MeshBounds>& meshBounds_;
  ChangedArea area_;
  std::vector<DrawnHull> casters_;  // that moved, at both places
  std::vector<Receiver> receivers_;
  std::vector<std::pair<Vec3, double>> groundPatches_;  // m; middles and sizes of the changed parts of the ground
  bool isWhole_ = false;
};

TileSpans ChangeFinder::spansOf(const DrawnHull& hull) {
  auto outline = outlineOf(hull, stage_);
  if (!outline) isWhole_ = true;
  return outline ? area_.picture.spansOf(std::move(*outline)) : TileSpans{};
}

template <typename Item>
void ChangeFinder::compareItems(const std::vector<Item>& before, const std::vector<Item>& now, bool throwsShadow) {
  const std::size_t size = std::max(before.size(), now.size());
  for (std::size_t i = 0; i < size && !isWhole_; ++i) {
    const Item* const old = i < before.size() ? &before[i] : nullptr;
    const Item* const current = i < now.size() ? &now[i] : nullptr;
    if (old && current && isSame(*old, *current, stage_)) {
      const std::size_t first = receivers_.size();
      addReceivers(*current);
      if constexpr (!std::is_same_v<Item, TubeItem>) compareNearBalls(*old, *current, first);
      continue;
    }
    for (const Item* item : {old, current}) {
      if (item == nullptr) continue;
      const DrawnHull around = hull(*item);
      area_.picture.add(spansOf(around));
      if (throwsShadow) appendCaster(around, casters_);
    }
  }
  if (area_.picture.coverage() > kWholeFrom) isWhole_ = true;
}

/// At the edge of a triangle seen edge-on, the middle of a pixel may lie far beyond it in depth: shading takes place
/// there.
void ChangeFinder::addReceiver(const DrawnHull& hull) {
  DrawnHull wide = hull;
  const double distance = (hull.middle() - stage_.camera.position).norm();
  wide.radius += kEdgePixels * distance * pixelAngle(stage_);
  receivers_.push_back({spansOf(hull), wide.bounds()});
}

template <typename Item>
void ChangeFinder::addReceivers(const Item& item) {
  if constexpr (std::is_same_v<Item, MeshItem>) {
    const MeshBounds& bounds = meshBounds_[static_cast<std::size_t>(item.mesh)];
    const std::uint32_t last = item.firstTriangle + item.triangleCount - 1;
    for (std::uint32_t run = item.firstTriangle / kTrianglesPerRun; run <= last / kTrianglesPerRun; ++run)
      addReceiver(hullOf(bounds.runs[run], item.worldFromMesh));
  } else {
    addReceiver(hullOf(item));
  }
}

/// Balls whose images or shade an item shows where they are near. A ball that is not near multiplies light by 1, so
/// that only the order of those that stay matters: where their number changes, all of them count. The item's receivers
/// stand from `first` on.
template <typename Item>
void ChangeFinder::compareNearBalls(const Item& before, const Item& now, std::size_t first) {
  const auto ballOf = [](const DrawList& list, const Item& item, int i) -> const NeighbourItem& {
    return list.neighbours[static_cast<std::size_t>(list.nearBalls[static_cast<std::size_t>(item.firstNearBall + i)])];
  };
  const bool sameNumber = before.nearBalls == now.nearBalls;
  for (int i = 0; i < std::max(before.nearBalls, now.nearBalls); ++i) {
    if (sameNumber && isSame(ballOf(before_, before, i), ballOf(now_, now, i), stage_)) continue;
    if (i < before.nearBalls) addAround(ballOf(before_, before, i), first);
    if (i < now.nearBalls) addAround(ballOf(now_, now, i), first);
  }
}

/// What of the receivers from `first` on a neighbour reaches.
void ChangeFinder::addAround(const NeighbourItem& item, std::size_t first) {
  DrawnHull around = hullOf(Bounds(-item.half, item.half), {item.rotation, item.center});
  around.radius = item.isBall() ? kBallReach * item.radius : item.radius;
  const Bounds reach = item.reach();
  for (std::size_t i = first; i < receivers_.size(); ++i)
    if (receivers_[i].bounds.intersects(reach)) addCommon(receivers_[i].spans, around);
}

void ChangeFinder::compareContacts() {
  if (!stage_.ground) return;
  const std::size_t size = std::max(before_.contacts.size(), now_.contacts.size());
  for (std::size_t i = 0; i < size && !isWhole_; ++i) {
    const bool isBoth = i < before_.contacts.size() && i < now_.contacts.size();
    if (isBoth && isSame(before_.contacts[i], now_.contacts[i], stage_)) continue;
    if (i < before_.contacts.size()) addDarkened(before_.contacts[i]);
    if (i < now_.contacts.size()) addDarkened(now_.contacts[i]);
  }
}

void ChangeFinder::addDarkened(const ContactItem& item) {
  const auto square = darkenedSquare(item, stage_);
  if (!square) return;
  area_.contactsChanged = true;
  const ShadedRegion& region = stage_.shaded;
  const double texel = kContactTexels * std::max(region.sizeU, region.sizeV) / kContactMapSize;
  const Ground& ground = *stage_.ground;
  const Vec3 middle = item.worldFromBox.translation;
  const Vec3 foot = middle - ground.normal.dot(middle - ground.point) * ground.normal;
  DrawnHull darkened;
  for (const double u : {-square->halfU - texel, square->halfU + texel})
    for (const double v : {-square->halfV - texel, square->halfV + texel})
      darkened.add(foot + u * region.axisU + v * region.axisV);
  area_.picture.add(spansOf(darkened));
  groundPatches_.emplace_back(darkened.middle(), darkened.reach());
}

/// How far beside a caster's outline in the light its shadow may change, `distance` m behind it.
double ChangeFinder::shadowMargin(double distance) const {
  const double cone = std::min(kLightRadius * std::max(distance, 0.0) / stage_.shadow.texel, kWidestRadius);
  return stage_.shadow.texel * std::max(kWidestRadius + kAroundDisc, cone + kAroundBlocks);
}

/// A ball's shadow on the ground is an ellipse, as long as the light is low.
void ChangeFinder::addShadowOnGround(const DrawnHull& caster) {
  const Vec3 light = stage_.lighting.lamps[0].towards;
  const Ground& ground = *stage_.ground;
  const double steepness = ground.normal.dot(light);
  if (steepness <= 0) return;
  const Vec3 level = light - steepness * ground.normal;
  const Vec3 along = level.norm() > 0 ? Vec3(level.normalized()) : stage_.shaded.axisU;
  const Vec3 across = ground.normal.cross(along);
  double highest = 0;
  for (std::size_t i = 0; i < caster.count; ++i)
    highest = std::max(highest, ground.normal.dot(caster.centers[i] - ground.point) + caster.radius);
  const double halfWidth = caster.radius + shadowMargin(highest / steepness), halfLength = halfWidth / steepness;
  std::vector<Eigen::Vector2d> outline;
  DrawnHull feet;
  for (std::size_t i = 0; i < caster.count; ++i) {
    const Vec3 center = caster.centers[i];
    const Vec3 foot = center - ground.normal.dot(center - ground.point) / steepness * light;
    DrawnHull corners;
    for (const double a : {-halfLength, halfLength})
      for (const double b : {-halfWidth, halfWidth}) corners.add(foot + a * along + b * across);
    const auto seen = outlineOf(corners, stage_);
    if (!seen) return void(isWhole_ = true);
    outline.insert(outline.end(), seen->begin(), seen->end());
    feet.add(foot);
    feet.radius = corners.reach();
  }
  area_.picture.add(area_.picture.spansOf(std::move(outline)));
  groundPatches_.emplace_back(feet.middle(), feet.reach());
}

/// On all that stands behind it in the light.
void ChangeFinder::addShadowOnItems(const DrawnHull& caster) {
  const Vec3 light = stage_.lighting.lamps[0].towards;
  const double nearest = light.dot(caster.middle()) + caster.reach();
  for (const Receiver& receiver : receivers_) {
    const Vec3 middle = receiver.bounds.center(), half = receiver.bounds.sizes() / 2;
    DrawnHull wide = caster;
    wide.radius += shadowMargin(nearest - light.dot(middle) + light.cwiseAbs().dot(half));
    const Bounds box = wide.bounds();
    const auto [first, last] = distancesOfOverlap(box, -light, receiver.bounds);
    if (first <= last) addCommon(receiver.spans, swept(wide, -first * light, -last * light));
  }
}

/// The part of a hull that lies in an item's tiles; all of these if the hull is not in front of the camera.
void ChangeFinder::addCommon(const TileSpans& item, const DrawnHull& hull) {
  auto outline = outlineOf(hull, stage_);
  area_.picture.add(outline ? commonTiles(item, area_.picture.spansOf(std::move(*outline))) : item);
}

/// Balls that mirror the changed ground. They show its shadows only as far as these are not blurred: where a ray is
/// wider than kBlurredTexels (environment.glsl). It widens with the surface's roughness, and with how the normal turns
/// from pixel to pixel.
void ChangeFinder::addMirrors(const Surface& surface, const DrawnHull& ball) {
  if (!mirrorsShadows(surface)) return;
  const Vec3 center = ball.middle();
  const double radius = ball.reach();
  const double pixel = pixelAngle(stage_) * std::max((center - stage_.camera.position).norm() - radius, 0.0);
  const double spread = surface.roughness * surface.roughness + kLeastTurn * 2 * pixel / radius;
  const double reach = kBlurredTexels * stage_.shadow.texel / spread + radius;
  for (const auto& [middle, size] : groundPatches_)
    if ((middle - center).norm() < size + reach) return area_.picture.add(spansOf(ball));
}

ChangedArea ChangeFinder::find() {
  compareItems(before_.meshes, now_.meshes, true);
  compareItems(before_.walls, now_.walls, false);
  compareItems(before_.spheres, now_.spheres, true);
  compareItems(before_.cylinders, now_.cylinders, true);
  compareItems(before_.tubes, now_.tubes, true);
  compareContacts();
  area_.shadows = shadowTexels(casters_, stage_);
  for (std::size_t i = 0; i < casters_.size() && !isWhole_; ++i) {
    if (stage_.ground) addShadowOnGround(casters_[i]);
    addShadowOnItems(casters_[i]);
    if (area_.picture.coverage() > kWholeFrom) isWhole_ = true;
  }
  for (const SphereItem& item : now_.spheres) addMirrors(item.surface, hull(item));
  for (const MeshItem& item : now_.meshes)
    if (item.isBall) addMirrors(item.surface, hull(item));
  return isWhole_ ? wholePicture(stage_) : std::move(area_);
}

}  // namespace

ChangedArea changedArea(const DrawList& before, const DrawList& now, const Stage& stage,
                        const std::vector<MeshBounds>& meshBounds) {
  return ChangeFinder(before, now, stage, meshBounds).find();
}

ChangedArea wholePicture(const Stage& stage) {
  ChangedArea whole{{stage.width, stage.height}, PixelRectangle{0, 0, kShadowMapSize, kShadowMapSize}, true};
  whole.picture.addAll();
  return whole;
}

}  // namespace cradle
