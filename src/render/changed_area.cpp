// What changes where something moves: its own pixels; its shadow on whatever stands behind it in the light; the sky's
// light and the mirror images that a sphere takes from and gives to what is near it; the darkened ground beneath it;
// and all spheres that mirror the ground with its shadows. Old and new place count alike.

#include "render/changed_area.h"

#include <algorithm>

#include "render/instances.h"
#include "render/light_receiver.h"
#include "render/mirrored_shadows.h"
#include "render/moved_shadows.h"
#include "render/shadow_casters.h"

namespace cradle {
namespace {

constexpr double kWholeFrom = 0.6;      // of the picture: from there on, drawing all of it costs less than finding out
constexpr long kFewTiles = 12;          // what is seen in so many is drawn as a whole: its parts are no smaller
constexpr double kHidingPixels = 2000;  // area of the least triangle that is asked whether it hides the ground
constexpr double kContactShadowTexels = 2;  // of the map of contact shadows, which is interpolated

/// Collects the area; once it is nearly everything, it is everything.
class ChangeFinder {
 public:
  ChangeFinder(const DrawList& before, const DrawList& now, const RenderSetup& setup,
               const std::vector<MeshBounds>& meshBounds)
      : before_(before),
        now_(now),
        setup_(setup),
        meshBounds_(meshBounds),
        area_{{setup.width, setup.height}, {}, false},
        mirrored_(setup) {}

  ChangedArea find();

 private:
  DrawnHull hull(const MeshItem& item) const {
    return hullOf(meshBounds_[static_cast<std::size_t>(item.mesh)].whole, item.worldFromMesh);
  }
  template <typename Item>
  DrawnHull hull(const Item& item) const {
    return hullOf(item);
  }

  TileSpans spansOf(const DrawnHull& hull);
  const TileSpans& spansOf(LightReceiver& receiver);
  template <typename Item>
  void compareItems(const std::vector<Item>& before, const std::vector<Item>& now, bool throwsShadow);
  template <typename Item>
  void addReceivers(const Item& item) {
    appendReceivers(item, setup_, receivers_);
  }
  void addReceivers(const MeshItem& item) {
    appendReceivers(item, meshBounds_[static_cast<std::size_t>(item.mesh)], setup_, receivers_);
  }
  template <typename Item>
  void compareNearOccluders(const Item& before, const Item& now, std::size_t first);
  void addAround(const OccluderItem& item, std::size_t first);
  void compareContactShadows();
  void addDarkened(const ContactShadowItem& item);
  void addCommon(const TileSpans& item, const DrawnHull& hull);
  void addShadows();
  TileMask hiddenGround();
  void addShadowsOnGround(const MovedShadows& shadows);
  void addShadowsOnItems(const MovedShadows& shadows);

  const DrawList &before_, &now_;
  const RenderSetup& setup_;
  const std::vector<MeshBounds>& meshBounds_;
  ChangedArea area_;
  std::vector<DrawnHull> casters_;  // that moved, at both places
  std::vector<LightReceiver> receivers_;
  MirroredShadows mirrored_;
  bool isWhole_ = false;
};

TileSpans ChangeFinder::spansOf(const DrawnHull& hull) {
  auto outline = outlineOf(hull, setup_);
  if (!outline) isWhole_ = true;
  return outline ? area_.picture.spansOf(std::move(*outline)) : TileSpans{};
}

const TileSpans& ChangeFinder::spansOf(LightReceiver& receiver) {
  if (!receiver.spans) receiver.spans = spansOf(receiver.hull);
  return *receiver.spans;
}

template <typename Item>
void ChangeFinder::compareItems(const std::vector<Item>& before, const std::vector<Item>& now, bool throwsShadow) {
  const std::size_t size = std::max(before.size(), now.size());
  for (std::size_t i = 0; i < size && !isWhole_; ++i) {
    const Item* const old = i < before.size() ? &before[i] : nullptr;
    const Item* const current = i < now.size() ? &now[i] : nullptr;
    if (old && current && isSame(*old, *current, setup_)) {
      const std::size_t first = receivers_.size();
      addReceivers(*current);
      if constexpr (!std::is_same_v<Item, TubeItem>) compareNearOccluders(*old, *current, first);
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

/// Spheres whose images or shade an item shows where they are near. A sphere that is not near multiplies light by 1:
/// where one comes or goes or moves, only its surroundings count, and the others as long as they keep their order. The
/// item's receivers stand from `first` on.
template <typename Item>
void ChangeFinder::compareNearOccluders(const Item& before, const Item& now, std::size_t first) {
  const auto occludersOf = [](const DrawList& list, const Item& item) {
    std::vector<const OccluderItem*> occluders;
    for (int i = item.firstNearOccluder; i < item.firstNearOccluder + item.nearOccluders; ++i)
      occluders.push_back(&list.occluders[static_cast<std::size_t>(list.nearOccluders[static_cast<std::size_t>(i)])]);
    return occluders;
  };
  const auto areSame = [&](const OccluderItem* a, const OccluderItem* b) { return isSame(*a, *b, setup_); };
  std::vector<const OccluderItem*> old = occludersOf(before_, before), current = occludersOf(now_, now);
  if (std::equal(old.begin(), old.end(), current.begin(), current.end(), areSame)) return;
  const auto addThoseNotIn = [&](const std::vector<const OccluderItem*>& others,
                                 std::vector<const OccluderItem*>& occluders) {
    std::erase_if(occluders, [&](const OccluderItem* occluder) {
      const bool stays =
          std::any_of(others.begin(), others.end(), [&](auto* other) { return areSame(occluder, other); });
      if (!stays) addAround(*occluder, first);
      return !stays;
    });
  };
  addThoseNotIn(current, old);
  addThoseNotIn(old, current);
  if (!std::equal(old.begin(), old.end(), current.begin(), current.end(), areSame))
    for (const OccluderItem* occluder : old) addAround(*occluder, first);
}

/// What of the receivers from `first` on an occluder reaches.
void ChangeFinder::addAround(const OccluderItem& item, std::size_t first) {
  DrawnHull around = hullOf(Bounds(-item.half, item.half), {item.rotation, item.center});
  around.radius = item.isSphere() ? kSphereReach * item.radius : item.radius;
  const Bounds reach = item.reach();
  auto outline = outlineOf(around, setup_);
  std::optional<TileSpans> tiles;
  if (outline) tiles = area_.picture.spansOf(std::move(*outline));
  for (std::size_t i = first; i < receivers_.size(); ++i) {
    const Bounds box = receivers_[i].hull.bounds();
    const double apart =
        item.isSphere() ? box.exteriorDistance(item.center) - around.radius : box.exteriorDistance(reach);
    if (apart > receivers_[i].wider) continue;
    area_.picture.add(tiles ? commonTiles(spansOf(receivers_[i]), *tiles) : spansOf(receivers_[i]));
  }
}

void ChangeFinder::compareContactShadows() {
  if (!setup_.ground) return;
  const std::size_t size = std::max(before_.contactShadows.size(), now_.contactShadows.size());
  for (std::size_t i = 0; i < size && !isWhole_; ++i) {
    const bool isBoth = i < before_.contactShadows.size() && i < now_.contactShadows.size();
    if (isBoth && isSame(before_.contactShadows[i], now_.contactShadows[i], setup_)) continue;
    if (i < before_.contactShadows.size()) addDarkened(before_.contactShadows[i]);
    if (i < now_.contactShadows.size()) addDarkened(now_.contactShadows[i]);
  }
}

void ChangeFinder::addDarkened(const ContactShadowItem& item) {
  const auto square = darkenedSquare(item, setup_);
  if (!square) return;
  area_.contactShadowsChanged = true;
  const ShadedRegion& region = setup_.shaded;
  const double texel = kContactShadowTexels * std::max(region.sizeU, region.sizeV) / kContactShadowMapSize;
  const Ground& ground = *setup_.ground;
  const Vec3 middle = item.worldFromBox.translation;
  const Vec3 foot = middle - ground.normal.dot(middle - ground.point) * ground.normal;
  DrawnHull darkened;
  for (const double u : {-square->halfU - texel, square->halfU + texel})
    for (const double v : {-square->halfV - texel, square->halfV + texel})
      darkened.add(foot + u * region.axisU + v * region.axisV);
  area_.picture.add(spansOf(darkened));
  mirrored_.addDarkened(darkened);
}

/// Tiles in which a long triangle that did not move, such as that of a base, hides the ground.
TileMask ChangeFinder::hiddenGround() {
  TileMask hidden(setup_.width, setup_.height);
  const Ground& ground = *setup_.ground;
  const auto isAbove = [&](const Vec3& point) { return ground.normal.dot(point - ground.point) > 0; };
  if (!isAbove(setup_.camera.position)) return hidden;
  for (const LightReceiver& receiver : receivers_) {
    if (!receiver.triangle || !std::all_of(receiver.triangle->begin(), receiver.triangle->end(), isAbove)) continue;
    const Vec3 normal =
        ((*receiver.triangle)[1] - (*receiver.triangle)[0]).cross((*receiver.triangle)[2] - (*receiver.triangle)[0]);
    const double pixel = pixelAngle(setup_) * (receiver.hull.middle() - setup_.camera.position).norm();
    if (normal.norm() / 2 < kHidingPixels * pixel * pixel) continue;
    if (auto outline = outlineOf({receiver.triangle->begin(), receiver.triangle->end()}, setup_))
      hidden.add(hidden.spansInside(std::move(*outline)));
  }
  return hidden;
}

void ChangeFinder::addShadowsOnGround(const MovedShadows& shadows) {
  const Ground& ground = *setup_.ground;
  if (ground.normal.dot(setup_.lighting.lamps[0].towards) <= 0) return;
  const TileMask hidden = hiddenGround();
  for (const std::vector<Vec3>& part : shadows.partsOf(shadows.surfaceOf(ground.normal, ground.point))) {
    auto outline = outlineOf(part, setup_);
    if (!outline) return void(isWhole_ = true);
    area_.picture.add(area_.picture.spansOf(std::move(*outline)), &hidden);
  }
}

/// On all that stands behind it in the light: on small things as a whole.
void ChangeFinder::addShadowsOnItems(const MovedShadows& shadows) {
  for (LightReceiver& receiver : receivers_) {
    const LitSurface surface = receiver.triangle ? shadows.surfaceOf(*receiver.triangle, receiver.wider)
                                                 : shadows.surfaceOf(receiver.hull, receiver.wider);
    if (!shadows.reach(surface)) continue;
    const TileSpans& spans = spansOf(receiver);
    if (spans.count() <= kFewTiles) {
      area_.picture.add(spans);
      continue;
    }
    for (const std::vector<Vec3>& part : shadows.partsOf(surface)) {
      auto outline = outlineOf(part, setup_);
      area_.picture.add(outline ? commonTiles(spans, area_.picture.spansOf(std::move(*outline))) : spans);
    }
  }
}

/// The part of a hull that lies in an item's tiles; all of these if the hull is not in front of the camera.
void ChangeFinder::addCommon(const TileSpans& item, const DrawnHull& hull) {
  auto outline = outlineOf(hull, setup_);
  area_.picture.add(outline ? commonTiles(item, area_.picture.spansOf(std::move(*outline))) : item);
}

ChangedArea ChangeFinder::find() {
  compareItems(before_.meshes, now_.meshes, true);
  compareItems(before_.walls, now_.walls, false);
  compareItems(before_.spheres, now_.spheres, true);
  compareItems(before_.cylinders, now_.cylinders, true);
  compareItems(before_.tubes, now_.tubes, true);
  compareContactShadows();
  area_.shadows = shadowTexels(casters_, setup_);
  if (!casters_.empty() && !isWhole_) addShadows();
  if (area_.picture.coverage() > kWholeFrom) isWhole_ = true;
  return isWhole_ ? wholePicture(setup_) : std::move(area_);
}

/// And what mirrors show of the ground.
void ChangeFinder::addShadows() {
  const MovedShadows shadows(casters_, setup_);
  addShadowsOnItems(shadows);
  if (!setup_.ground) return;
  addShadowsOnGround(shadows);
  for (const DrawnHull& caster : casters_) mirrored_.addCaster(caster);
  for (const SphereItem& item : now_.spheres)
    for (const DrawnHull& image : mirrored_.imagesOn(item, now_)) addCommon(spansOf(hullOf(item)), image);
  for (const MeshItem& item : now_.meshes)
    if (mirrored_.areSeenOn(item, meshBounds_[static_cast<std::size_t>(item.mesh)]))
      area_.picture.add(spansOf(hull(item)));
}

}  // namespace

ChangedArea changedArea(const DrawList& before, const DrawList& now, const RenderSetup& setup,
                        const std::vector<MeshBounds>& meshBounds) {
  return ChangeFinder(before, now, setup, meshBounds).find();
}

ChangedArea wholePicture(const RenderSetup& setup) {
  ChangedArea whole{{setup.width, setup.height}, PixelRectangle{0, 0, kShadowMapSize, kShadowMapSize}, true};
  whole.picture.addAll();
  return whole;
}

}  // namespace cradle
