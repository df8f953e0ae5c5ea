#include "experiments/touching_places.h"

#include <limits>

#include "collision/separation.h"
#include "experiments/experiment.h"
#include "simulate/assembly.h"
#include "simulate/plan/plan_islands.h"

namespace cradle {
namespace {

constexpr double kFar = 4;              // m: from where a body comes, and beyond which it has missed
constexpr double kGapRounding = 4e-16;  // m
constexpr int kMaxMoves = 40;           // each leaves less than half, where surfaces meet steeper than 60 degrees

Scene sceneOfBodies(SceneSketch sketch) {
  sketch.links.clear();
  for (SketchBody& body : sketch.bodies)
    if (body.drive) body.worldFromBody = startPoseOf(body), body.isStatic = true, body.drive.reset();
  return parseScene(textOf(sketch), "sketch.json", modelFilesBeside("sketch.json")).scene;
}

/// The last body of a sketch among the others.
class LastBody {
 public:
  explicit LastBody(const SceneSketch& sketch)
      : scene_(sceneOfBodies(sketch)), assembly_(assemble(scene_, touchingScene(scene_))) {
    const int last = static_cast<int>(sketch.bodies.size()) - 1;
    index_ = static_cast<Eigen::Index>(indexAmong(assembly_.sceneBodies, last));
    ContactGeometry& geometry = assembly_.geometry;
    geometry.pairs.clear();
    const std::size_t collider = geometry.colliders.size() - 1;
    for (std::size_t i = 0; i < geometry.planes.size(); ++i) {
      geometry.pairs.push_back({collider, i, true, {}});
      others_.push_back(assembly_.planeBodies[i]);
    }
    for (std::size_t i = 0; i < collider; ++i) {
      geometry.pairs.push_back({i, collider, false, {}});
      others_.push_back(assembly_.colliderBodies[i]);
    }
    start_ = centerOfMass(assembly_.state, index_);
  }

  void moveTo(const Vec3& displacement) { centerOfMass(assembly_.state, index_) = start_ + displacement; }

  /// m, and the pair that is nearest.
  std::pair<double, std::size_t> separation() const {
    const ContactGeometry& geometry = assembly_.geometry;
    std::pair<double, std::size_t> least{std::numeric_limits<double>::infinity(), 0};
    std::vector<std::size_t> features;
    for (std::size_t pair = 0; pair < geometry.pairs.size(); ++pair) {
      features.clear();
      const RigidTransform worldFromA = poseOf(assembly_.state, geometry.colliders[geometry.pairs[pair].a].body);
      appendFeaturesWithin(geometry, geometry.pairs[pair], worldFromA, 2 * kFar, features);
      for (const std::size_t feature : features) {
        const double found = cradle::separation(geometry, geometry.pairs[pair], feature, assembly_.state);
        if (found < least.first) least = {found, pair};
      }
    }
    return least;
  }

  std::optional<NearestPlace> nearest() const {
    const auto [separation, pair] = this->separation();
    std::vector<Contact> contacts;
    appendContacts(assembly_.geometry, pair, assembly_.state, separation + 1e-12, contacts);
    if (contacts.empty()) return {};
    const Contact& contact = contacts.front();
    const bool isA = contact.bodyA == static_cast<int>(index_);
    return NearestPlace{separation, others_[pair], contact.point, isA ? contact.normal : Vec3(-contact.normal)};
  }

 private:
  Scene scene_;
  Assembly assembly_;
  Eigen::Index index_ = 0;
  std::vector<int> others_;  // scene body of each pair
  Vec3 start_ = Vec3::Zero();
};

}  // namespace

IslandPlan touchingScene(const Scene& scene) {
  IslandPlan all;
  for (int body = 0; body < static_cast<int>(scene.bodies.size()); ++body) {
    const Body& found = scene.bodies[static_cast<std::size_t>(body)];
    if (found.collision != CollisionChoice::none) all.touching.push_back(body);
    if (found.motion == Motion::dynamic) all.bodies.push_back(body);
    if (found.motion == Motion::driven) all.driven.push_back(body);
  }
  forEachLink(scene, [&](const LinkIndex& link, const Anchor&, const Anchor&) { all.links.push_back(link); });
  return all;
}

std::optional<NearestPlace> nearestPlace(const SceneSketch& sketch) {
  return LastBody(sketch).nearest();
}

// A separation falls by no more than the way gone: what is left of it can always be gone.
bool moveToTouch(SceneSketch& sketch, const Vec3& direction, double gap) {
  Vec3& place = sketch.bodies.back().worldFromBody.translation;
  const double size = sizeOf(sketch.bodies.back());
  place -= kFar * direction;
  LastBody body(sketch);
  double way = 0, left = kFar;
  for (int i = 0; i < kMaxMoves && way < 2 * kFar; ++i) {
    body.moveTo(way * direction);
    left = body.separation().first - gap;
    if (std::abs(left) <= kGapRounding) break;
    way += left;
  }
  place += way * direction;
  return std::abs(left) <= std::max(0.1 * gap, 1e-12 * size);
}

}  // namespace cradle
