#include "render/instances.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cradle {
namespace {

constexpr double kVisibleCorner = 0.25;  // pixels
constexpr double kContactReach = 2.5;  // times the height of what touches the ground; beyond, 7 % of the sky are hidden

void put(Instance& instance, std::size_t attribute, const Vec3f& vector, double last) {
  float* numbers = instance.data() + 4 * attribute;
  std::copy(vector.begin(), vector.end(), numbers);
  numbers[3] = static_cast<float>(last);
}

/// Attributes 0..2: rows of `matrix` with `translation`.
void putTransform(Instance& instance, const Mat3& matrix, const Vec3& translation) {
  for (int row = 0; row < 3; ++row)
    put(instance, static_cast<std::size_t>(row), matrix.row(row).transpose().cast<float>(), translation[row]);
}

/// Attributes 3..5 of an item with a surface and balls near it; the first numbers of 3 are left alone.
template <typename Item>
void putLook(const Item& item, Instance& instance) {
  instance[15] = item.surface.roughness;
  put(instance, 4, item.surface.color, item.surface.metallic);
  put(instance, 5, Vec3f(static_cast<float>(item.firstNearBall), static_cast<float>(item.nearBalls), 0), 0);
}

Instance packMesh(const MeshItem& item, const Stage& stage) {
  Instance instance{};
  putTransform(instance, item.worldFromMesh.rotation.toRotationMatrix(), item.worldFromMesh.translation - stage.origin);
  putLook(item, instance);
  return instance;
}

Instance packRound(const SphereItem& item, const Stage& stage) {
  Instance instance{};
  put(instance, 0, stage.relative(item.center), item.radius);
  return instance;
}

Instance packRound(const CylinderItem& item, const Stage& stage) {
  Instance instance{};
  put(instance, 0, stage.relative(item.center), item.radius);
  put(instance, 1, item.axis.cast<float>(), item.length);
  return instance;
}

/// How fine an outline has to be: a polygon of n corners, as large as the circle, misses it by r (pi / n)^2 / 3.
std::size_t outlineFor(const Bounds& bounds, double radius, const Stage& stage) {
  const double distance = std::max(bounds.exteriorDistance(stage.camera.position), 1e-9);
  const double pixels = radius / distance * stage.height / (2 * std::tan(stage.camera.verticalFieldOfView / 2));
  for (std::size_t i = 0; i + 1 < kOutlines.size(); ++i)
    if (pixels * std::pow(std::numbers::pi / kOutlines[i], 2) / 3 < kVisibleCorner) return i;
  return kOutlines.size() - 1;
}

template <typename Item>
void packRounds(const std::vector<Item>& items, const Stage& stage, std::vector<Instance>& instances,
                std::vector<Batch>& batches) {
  std::vector<std::size_t> levels;
  for (const Item& item : items) levels.push_back(outlineFor(item.bounds(), item.radius, stage));
  for (std::size_t level = 0; level < kOutlines.size(); ++level) {
    Batch batch{static_cast<int>(level), 0, 0, instances.size(), 0};
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (levels[i] != level) continue;
      Instance instance = packRound(items[i], stage);
      putLook(items[i], instance);
      instances.push_back(instance);
    }
    batch.instanceCount = instances.size() - batch.firstInstance;
    if (batch.instanceCount > 0) batches.push_back(batch);
  }
}

Instance packTube(const TubeItem& item, const Stage& stage) {
  Instance instance{};
  put(instance, 0, stage.relative(item.start), item.wireRadius);
  put(instance, 1, stage.relative(item.end), item.coilRadius);
  put(instance, 2, item.side.cast<float>(), item.turns);
  put(instance, 3, item.sag.cast<float>(), item.surface.roughness);
  put(instance, 4, item.surface.color, item.surface.metallic);
  put(instance, 5, Vec3f(0, 0, static_cast<float>(item.straightEnd)), 0);
  return instance;
}

/// The square of the contact map that an item may darken; none if it is too far above the ground.
bool packContact(const ContactItem& item, const Stage& stage, Instance& instance) {
  const Ground& ground = *stage.ground;
  const ShadedRegion& region = stage.shaded;
  const Mat3 turn = item.worldFromBox.rotation.toRotationMatrix();
  const Vec3 center = item.worldFromBox.translation;
  const auto extentAlong = [&](const Vec3& axis) {
    const Vec3 inBox = (turn.transpose() * axis).cwiseProduct(item.half);
    return item.kind == ContactKind::ellipsoid ? inBox.norm() : inBox.cwiseAbs().sum();
  };
  const double reach = std::min(kContactReach * 2 * item.half.minCoeff(), region.margin);
  const double gap = ground.normal.dot(center - ground.point) - extentAlong(ground.normal);
  if (gap > reach || gap < -2 * extentAlong(ground.normal)) return false;

  const Vec3 relative = center - stage.origin;
  putTransform(instance, turn.transpose(), -(turn.transpose() * relative));
  put(instance, 3, item.half.cast<float>(), reach);
  const double u = 2 * (region.axisU.dot(relative) - region.firstU) / region.sizeU - 1;
  const double v = 2 * (region.axisV.dot(relative) - region.firstV) / region.sizeV - 1;
  put(instance, 4, Vec3(u, v, 0).cast<float>(), static_cast<int>(item.kind));
  put(instance, 5,
      Vec3(2 * (extentAlong(region.axisU) + reach) / region.sizeU,
           2 * (extentAlong(region.axisV) + reach) / region.sizeV, 0)
          .cast<float>(),
      0);
  return true;
}

void packBatches(const DrawList& list, PackedDrawList& packed) {
  for (std::size_t i = 0; i < list.meshes.size(); ++i) {
    const MeshItem& item = list.meshes[i];
    const bool continues = !packed.meshBatches.empty() && packed.meshBatches.back().mesh == item.mesh &&
                           packed.meshBatches.back().firstTriangle == item.firstTriangle &&
                           packed.meshBatches.back().triangleCount == item.triangleCount;
    if (!continues) packed.meshBatches.push_back({item.mesh, item.firstTriangle, item.triangleCount, i, 0});
    ++packed.meshBatches.back().instanceCount;
  }
}

}  // namespace

PackedDrawList pack(const DrawList& list, const Stage& stage) {
  PackedDrawList packed;
  for (const MeshItem& item : list.meshes) packed.meshInstances.push_back(packMesh(item, stage));
  for (const TubeItem& item : list.tubes) packed.tubeInstances.push_back(packTube(item, stage));
  for (const MeshItem& item : list.walls) packed.wallInstances.push_back(packMesh(item, stage));
  packBatches(list, packed);
  packRounds(list.spheres, stage, packed.sphereInstances, packed.sphereBatches);
  packRounds(list.cylinders, stage, packed.cylinderInstances, packed.cylinderBatches);
  for (const BallItem& ball : list.balls) {
    const Vec3f center = stage.relative(ball.center);
    packed.balls.insert(packed.balls.end(), {center.x(), center.y(), center.z(), static_cast<float>(ball.radius)});
    packed.balls.insert(packed.balls.end(), ball.surface.color.begin(), ball.surface.color.end());
    packed.balls.push_back(ball.surface.metallic);
  }
  for (const int index : list.nearBalls) packed.nearBalls.push_back(static_cast<float>(index));
  Instance instance{};
  if (stage.ground)
    for (const ContactItem& item : list.contacts)
      if (packContact(item, stage, instance)) packed.contactInstances.push_back(instance);
  return packed;
}

}  // namespace cradle
