#include "render/instances.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cradle {
namespace {

constexpr float kTrembling = 1e-12f;     // m, or of a direction
constexpr double kVisibleCorner = 0.25;  // pixels
constexpr float kMirrorMetallic = 0.5f, kMirrorRoughness = 0.35f;
constexpr double kContactShadowReach =
    2.5;  // times the height of what touches the ground; beyond, 7 % of the sky are hidden

/// What trembles in its last digits beside zero is at rest.
float settled(float number) {
  return std::abs(number) < kTrembling ? 0.0f : number;
}

void put(Instance& instance, std::size_t attribute, const Vec3f& vector, double last) {
  float* numbers = instance.data() + 4 * attribute;
  std::transform(vector.begin(), vector.end(), numbers, settled);
  numbers[3] = settled(static_cast<float>(last));
}

/// Attributes 0..2: rows of `matrix` with `translation`.
void putTransform(Instance& instance, const Mat3& matrix, const Vec3& translation) {
  for (int row = 0; row < 3; ++row)
    put(instance, static_cast<std::size_t>(row), matrix.row(row).transpose().cast<float>(), translation[row]);
}

/// Attributes 3..5 of an item with a surface and occluders near it.
template <typename Item>
void putLook(const Item& item, bool isSphere, Instance& instance) {
  const Surface& surface = item.surface;
  put(instance, 3, surface.pattern == Pattern::none ? Vec3f(Vec3f::Zero()) : surface.patternColor, surface.roughness);
  put(instance, 4, surface.color, surface.metallic);
  const int kinds = 2 * static_cast<int>(surface.pattern) + (isSphere && mirrorsShadows(surface) ? 1 : 0);
  put(instance, 5,
      Vec3f(static_cast<float>(item.firstNearOccluder), static_cast<float>(item.nearOccluders),
            static_cast<float>(kinds)),
      surface.pattern == Pattern::none ? 0 : surface.patternCell);
}

/// How fine an outline has to be: a polygon of n corners, as large as the circle, misses it by r (pi / n)^2 / 3.
std::size_t outlineFor(const Bounds& bounds, double radius, const RenderSetup& setup) {
  const double distance = std::max(bounds.exteriorDistance(setup.camera.position), 1e-9);
  const double pixels = radius / distance * setup.height / (2 * std::tan(setup.camera.verticalFieldOfView / 2));
  for (std::size_t i = 0; i + 1 < kOutlines.size(); ++i)
    if (pixels * std::pow(std::numbers::pi / kOutlines[i], 2) / 3 < kVisibleCorner) return i;
  return kOutlines.size() - 1;
}

/// Where rounds go: instances, their batches, and which item each instance is.
struct PackedRounds {
  std::vector<Instance>& instances;
  std::vector<Batch>& batches;
  std::vector<std::size_t>& order;
};

template <typename Item>
void packRounds(const std::vector<Item>& items, const RenderSetup& setup, const PackedRounds& packed) {
  auto& [instances, batches, order] = packed;
  std::vector<std::size_t> levels;
  for (const Item& item : items) levels.push_back(outlineLevel(item, setup));
  for (std::size_t level = 0; level < kOutlines.size(); ++level) {
    Batch batch{static_cast<int>(level), 0, 0, instances.size(), 0};
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (levels[i] != level) continue;
      instances.push_back(instanceOf(items[i], setup));
      order.push_back(i);
    }
    batch.instanceCount = instances.size() - batch.firstInstance;
    if (batch.instanceCount > 0) batches.push_back(batch);
  }
}

double extentAlong(const Vec3& axis, const ContactShadowItem& item) {
  const Vec3 inBox = (item.worldFromBox.rotation.conjugate() * axis).cwiseProduct(item.half);
  return item.kind == ContactShadowShape::ellipsoid ? inBox.norm() : inBox.cwiseAbs().sum();
}

void packBatches(const DrawList& list, PackedDrawList& packed) {
  for (std::size_t i = 0; i < list.meshes.size(); ++i) {
    const MeshItem& item = list.meshes[i];
    const bool continues = !packed.meshBatches.empty() && packed.meshBatches.back().mesh == item.mesh &&
                           packed.meshBatches.back().firstTriangle == item.firstTriangle &&
                           packed.meshBatches.back().triangleCount == item.triangleCount &&
                           packed.meshBatches.back().texture == item.surface.texture;
    if (!continues)
      packed.meshBatches.push_back({item.mesh, item.firstTriangle, item.triangleCount, i, 0, item.surface.texture});
    ++packed.meshBatches.back().instanceCount;
  }
}

template <typename Item>
bool haveSameNumbers(const Item& a, const Item& b, const RenderSetup& setup) {
  Instance first = instanceOf(a, setup), second = instanceOf(b, setup);
  for (const std::size_t number : kNearOccluderNumbers) first[number] = second[number] = 0;
  return first == second;
}

}  // namespace

std::optional<DarkenedSquare> darkenedSquare(const ContactShadowItem& item, const RenderSetup& setup) {
  const Ground& ground = *setup.ground;
  const ShadedRegion& region = setup.shaded;
  const double reach = std::min(kContactShadowReach * 2 * item.half.minCoeff(), region.margin);
  const double height = extentAlong(ground.normal, item);
  const double gap = ground.normal.dot(item.worldFromBox.translation - ground.point) - height;
  if (gap > reach || gap < -2 * height) return std::nullopt;
  return DarkenedSquare{extentAlong(region.axisU, item) + reach, extentAlong(region.axisV, item) + reach, reach};
}

bool mirrorsShadows(const Surface& surface) {
  return surface.metallic > kMirrorMetallic && surface.roughness < kMirrorRoughness;
}

Instance instanceOf(const MeshItem& item, const RenderSetup& setup) {
  Instance instance{};
  putTransform(instance, item.worldFromMesh.rotation.toRotationMatrix(), item.worldFromMesh.translation - setup.origin);
  putLook(item, item.isSphere, instance);
  return instance;
}

Instance instanceOf(const SphereItem& item, const RenderSetup& setup) {
  Instance instance{};
  put(instance, 0, setup.relative(item.center), item.radius);
  if (item.surface.pattern != Pattern::none) put(instance, 1, item.rotation.vec().cast<float>(), item.rotation.w());
  putLook(item, true, instance);
  return instance;
}

Instance instanceOf(const CylinderItem& item, const RenderSetup& setup) {
  Instance instance{};
  put(instance, 0, setup.relative(item.center), item.radius);
  put(instance, 1, item.axis.cast<float>(), item.length);
  if (item.surface.pattern != Pattern::none) put(instance, 2, item.side.cast<float>(), 0);
  putLook(item, false, instance);
  return instance;
}

Instance instanceOf(const TubeItem& item, const RenderSetup& setup) {
  Instance instance{};
  put(instance, 0, setup.relative(item.start), item.wireRadius);
  put(instance, 1, setup.relative(item.end), item.coilRadius);
  put(instance, 2, item.side.cast<float>(), item.turns);
  put(instance, 3, item.sag.cast<float>(), item.surface.roughness);
  put(instance, 4, item.surface.color, item.surface.metallic);
  const bool isRope = item.turns == 0;
  put(instance, 5, Vec3f(0, 0, static_cast<float>(isRope ? item.slack : item.straightEnd)), item.lean);
  return instance;
}

Instance instanceOf(const ContactShadowItem& item, const DarkenedSquare& square, const RenderSetup& setup) {
  Instance instance{};
  const ShadedRegion& region = setup.shaded;
  const Mat3 turn = item.worldFromBox.rotation.toRotationMatrix();
  const Vec3 relative = item.worldFromBox.translation - setup.origin;
  putTransform(instance, turn.transpose(), -(turn.transpose() * relative));
  put(instance, 3, item.half.cast<float>(), square.reach);
  const double u = 2 * (region.axisU.dot(relative) - region.firstU) / region.sizeU - 1;
  const double v = 2 * (region.axisV.dot(relative) - region.firstV) / region.sizeV - 1;
  put(instance, 4, Vec3(u, v, 0).cast<float>(), static_cast<int>(item.kind));
  put(instance, 5, Vec3(2 * square.halfU / region.sizeU, 2 * square.halfV / region.sizeV, 0).cast<float>(), 0);
  return instance;
}

std::size_t outlineLevel(const SphereItem& item, const RenderSetup& setup) {
  return outlineFor(item.bounds(), item.radius, setup);
}

std::size_t outlineLevel(const CylinderItem& item, const RenderSetup& setup) {
  return outlineFor(item.bounds(), item.radius, setup);
}

std::array<float, 16> numbersOf(const OccluderItem& item, const RenderSetup& setup) {
  const Vec3f center = setup.relative(item.center), half = item.half.cast<float>();
  const Vec3f& color = item.surface.color;
  const Eigen::Vector4f turn = item.rotation.coeffs().cast<float>();
  return {settled(center.x()),
          settled(center.y()),
          settled(center.z()),
          static_cast<float>(item.radius),
          color.x(),
          color.y(),
          color.z(),
          item.surface.metallic,
          half.x(),
          half.y(),
          half.z(),
          item.isSphere() ? 0.0f : 1.0f,
          settled(turn.x()),
          settled(turn.y()),
          settled(turn.z()),
          settled(turn.w())};
}

bool isSame(const MeshItem& a, const MeshItem& b, const RenderSetup& setup) {
  return a.mesh == b.mesh && a.firstTriangle == b.firstTriangle && a.triangleCount == b.triangleCount &&
         a.surface.texture == b.surface.texture && haveSameNumbers(a, b, setup);
}

bool isSame(const SphereItem& a, const SphereItem& b, const RenderSetup& setup) {
  return outlineLevel(a, setup) == outlineLevel(b, setup) && haveSameNumbers(a, b, setup);
}

bool isSame(const CylinderItem& a, const CylinderItem& b, const RenderSetup& setup) {
  return outlineLevel(a, setup) == outlineLevel(b, setup) && haveSameNumbers(a, b, setup);
}

bool isSame(const TubeItem& a, const TubeItem& b, const RenderSetup& setup) {
  return haveSameNumbers(a, b, setup);
}

bool isSame(const OccluderItem& a, const OccluderItem& b, const RenderSetup& setup) {
  return numbersOf(a, setup) == numbersOf(b, setup);
}

bool isSame(const ContactShadowItem& a, const ContactShadowItem& b, const RenderSetup& setup) {
  const auto first = darkenedSquare(a, setup), second = darkenedSquare(b, setup);
  if (!first || !second) return !first && !second;
  return instanceOf(a, *first, setup) == instanceOf(b, *second, setup);
}

PackedDrawList pack(const DrawList& list, const RenderSetup& setup) {
  PackedDrawList packed;
  for (const MeshItem& item : list.meshes) packed.meshInstances.push_back(instanceOf(item, setup));
  for (const TubeItem& item : list.tubes) packed.tubeInstances.push_back(instanceOf(item, setup));
  for (const MeshItem& item : list.walls) packed.wallInstances.push_back(instanceOf(item, setup));
  packBatches(list, packed);
  packRounds(list.spheres, setup, {packed.sphereInstances, packed.sphereBatches, packed.sphereItems});
  packRounds(list.cylinders, setup, {packed.cylinderInstances, packed.cylinderBatches, packed.cylinderItems});
  for (const OccluderItem& item : list.occluders) {
    const auto numbers = numbersOf(item, setup);
    packed.occluders.insert(packed.occluders.end(), numbers.begin(), numbers.end());
  }
  for (const int index : list.nearOccluders) packed.nearOccluders.push_back(static_cast<float>(index));
  if (setup.ground)
    for (const ContactShadowItem& item : list.contactShadows)
      if (const auto square = darkenedSquare(item, setup))
        packed.contactShadowInstances.push_back(instanceOf(item, *square, setup));
  return packed;
}

}  // namespace cradle
