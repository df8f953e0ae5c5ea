// With the direction of view fixed beforehand, the best place of the camera follows from four numbers: how far things
// reach towards the planes that bound the picture on the right, left, top and bottom. Each is a maximum of linear
// functions of the points shown, so that frames can be added one by one.

#include "render/framing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "math/rotation.h"
#include "render/body_place.h"
#include "render/camera.h"
#include "render/camera_path.h"
#include "render/motor_arrows.h"

namespace cradle {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kFieldOfView = 32 * kDegree;  // long enough that spheres at the border stay round
constexpr double kElevation = 10 * kDegree;    // from above, with the horizon still in the picture
// Turned so far aside from the axes of the world; against the default light first, so that shadows fall aside, too.
constexpr double kAsideAngle = 24 * kDegree;
constexpr std::array<double, 8> kAzimuths = {-kAsideAngle,
                                             kAsideAngle,
                                             180 * kDegree + kAsideAngle,
                                             180 * kDegree - kAsideAngle,
                                             90 * kDegree + kAsideAngle,
                                             90 * kDegree - kAsideAngle,
                                             270 * kDegree - kAsideAngle,
                                             270 * kDegree + kAsideAngle};
constexpr std::size_t kFirstAlongX = 4;  // azimuths from there on look along x, those before along z
constexpr double kSlopeInView = 0.1;     // sine of the least height of the camera over a slope
constexpr double kClearlyAlong = 1.5;    // times the spread across
constexpr double kFilled = 0.84;         // share of the picture that things may fill
constexpr double kLargestFixed = 3;      // fixed bodies larger than so many times what moves are scenery
constexpr double kLongestArrow = 0.2;    // of the size of what moves
constexpr double kShortestArrow = 0.45;  // of the longest one
constexpr double kSmallestArc = 0.4;     // radius, of the longest arrow
constexpr double kArcGap = 0.06;         // between it and its body, of the longest arrow
constexpr double kSizeOfSeen = 1.5;      // of the height of the picture: what moves will fill it
constexpr double kSmallestReach = 1e-6;  // m, of a scene that shows nothing

Mat3 axesFrom(double azimuth, double elevation) {
  const Vec3 back(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                  std::cos(azimuth) * std::cos(elevation));
  return cameraAxes(back, Vec3::Zero());
}

}  // namespace

void Framing::Reach::include(const Reach& other) {
  right = std::max(right, other.right);
  left = std::max(left, other.left);
  top = std::max(top, other.top);
  bottom = std::max(bottom, other.bottom);
}

Framing::Reach Framing::emptyReach() {
  constexpr double kNothing = -std::numeric_limits<double>::infinity();
  return {kNothing, kNothing, kNothing, kNothing};
}

double Framing::Solid::support(const Vec3& direction) const {
  const double atOrigin = direction.dot(worldFromLocal.translation);
  if (radius > 0) return atOrigin + radius * direction.norm();
  const Vec3 inward = worldFromLocal.rotation.conjugate() * direction;
  return atOrigin + inward.dot(local.center()) + inward.cwiseAbs().dot(local.sizes() / 2);
}

double View::size() const {
  const double shown = std::max(bounds.isEmpty() ? 0 : bounds.diagonal().norm(), kSizeOfSeen * seen);
  return shown > 0 ? shown : 1;
}

double View::arrowLength(const ShownPush& push) const {
  double greatest = 0;
  for (const ShownPush& other : pushes)
    if (other.isTorque == push.isTorque) greatest = std::max(greatest, other.force.norm());
  const double force = push.force.norm();
  return force > 0 ? longestArrow * (kShortestArrow + (1 - kShortestArrow) * force / greatest) : 0;
}

double View::arcRadius(const ShownPush& push) const {
  return std::max(push.clearance + kArcGap * longestArrow, kSmallestArc * longestArrow);
}

Framing::Framing(const Scene& scene, int width, int height, std::vector<ShownPush> pushes)
    : scene_(scene),
      pushes_(std::move(pushes)),
      tanHalfX_(kFilled * std::tan(kFieldOfView / 2) * width / height),
      tanHalfY_(kFilled * std::tan(kFieldOfView / 2)) {
  for (const Body& body : scene.bodies) localBounds_.push_back(localBounds(scene, body));
  for (const double azimuth : kAzimuths) {
    Candidate candidate{axesFrom(azimuth, kElevation), {}, emptyReach()};
    const Vec3 right = candidate.axes.col(0), up = candidate.axes.col(1), back = candidate.axes.col(2);
    candidate.outwards = {right + tanHalfX_ * back, -right + tanHalfX_ * back, up + tanHalfY_ * back,
                          -up + tanHalfY_ * back};
    candidates_.push_back(candidate);
  }
  const auto addAnchor = [&](const Anchor& anchor) {
    if (anchor.body == kWorld) includeMoving({Bounds(Vec3::Zero(), Vec3::Zero()), 0, {Quat::Identity(), anchor.point}});
  };
  forEachKindOfLink(scene, [&](const auto& links) {
    for (const auto& link : links) addAnchor(link.anchorA), addAnchor(link.anchorB);
  });
}

std::vector<Framing::Solid> Framing::solidsOf(const std::vector<RigidTransform>& places, bool areMoving) const {
  std::vector<Solid> solids;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const bool moves = scene_.bodies[i].motion != Motion::fixed;
    if (moves != areMoving || localBounds_[i].isEmpty()) continue;
    const Sphere* sphere = std::get_if<Sphere>(&scene_.bodies[i].shape);
    solids.push_back({localBounds_[i], sphere != nullptr ? sphere->radius : 0, places[i]});
  }
  return solids;
}

Framing::Reach Framing::reachOf(const Candidate& candidate, const Solid& solid) {
  return {solid.support(candidate.outwards[0]), solid.support(candidate.outwards[1]),
          solid.support(candidate.outwards[2]), solid.support(candidate.outwards[3])};
}

void Framing::includeMoving(const Solid& solid) {
  for (Candidate& candidate : candidates_) candidate.moving.include(reachOf(candidate, solid));
  movingBounds_.extend(transformed(solid.local, solid.worldFromLocal));
}

void Framing::includeMotorArrows(const Frame& frame, const std::vector<RigidTransform>& places) {
  for (const Vec3& point : outlineOfMotorArrows(scene_, localBounds_, frame, places)) {
    const Solid solid{Bounds(Vec3::Zero(), Vec3::Zero()), 0, {Quat::Identity(), point}};
    for (Candidate& candidate : candidates_) candidate.moving.include(reachOf(candidate, solid));
    motorArrowBounds_.extend(point);
  }
}

void Framing::add(const Frame& frame) {
  const auto places = placeBodies(scene_, frame);
  if (scene_.camera && !start_) start_ = CameraPath(scene_).next(frame.time, places);
  for (std::size_t i = 0; i < pushes_.size(); ++i)
    if (pushes_[i].isShownAt(frame.time)) arrowPlaces_.push_back({i, pushes_[i].pointAt(frame.time, places)});
  if (!scene_.camera) includeMotorArrows(frame, places);
  for (const Solid& solid : solidsOf(places, true)) {
    includeMoving(solid);
    ++places_;
    placeSum_ += solid.worldFromLocal.translation;
    placeSquareSum_ += solid.worldFromLocal.translation.cwiseAbs2();
  }
}

bool Framing::seesGround(const Candidate& candidate) const {
  for (const Body& body : scene_.bodies) {
    const Plane* plane = std::get_if<Plane>(&body.shape);
    if (plane == nullptr) continue;
    const Vec3 normal = body.worldFromBody.rotation * plane->normal;
    if (isFloor(normal) && normal.dot(candidate.axes.col(2)) < kSlopeInView) return false;
  }
  return true;
}

/// By the spread of all places of all bodies, for which a single one that runs away counts little.
bool Framing::movesAlongZ() const {
  if (places_ == 0) return false;
  const double count = static_cast<double>(places_);
  const Vec3 variance = placeSquareSum_ / count - (placeSum_ / count).cwiseAbs2();
  return variance.z() > kClearlyAlong * kClearlyAlong * std::max(variance.x(), 0.0);
}

const Framing::Candidate& Framing::bestCandidate() const {
  // Across the motion rather than along it; and never from behind a slope.
  const std::size_t first = movesAlongZ() ? kFirstAlongX : 0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& candidate = candidates_[(first + i) % candidates_.size()];
    if (seesGround(candidate)) return candidate;
  }
  return candidates_[first];
}

/// The scene's camera, what it looks at, and where it is going to be: nothing of it asks how the motion goes on.
void Framing::lookFromScene(View& view) const {
  const Camera& camera = view.camera = *start_;
  if (view.bounds.isEmpty()) view.bounds.extend(camera.target);
  view.seen = 2 * std::tan(camera.verticalFieldOfView / 2) * (view.bounds.center() - camera.position).norm();
  view.longestArrow = kLongestArrow * view.size();
  for (const CameraMotion::Key& key : scene_.cameraMotion.keys) {
    Camera& then = view.keys.emplace_back(camera);
    then.position = key.position;
    then.target = scene_.cameraMotion.targetBody == kWorld ? key.target : Vec3(view.bounds.center());
    then.verticalFieldOfView = key.verticalFieldOfView;
  }
}

/// Arrows are as long as the motion of the whole film says, which is known after its last frame only.
void Framing::includeArrows(View& view, std::vector<Solid>& shown) const {
  if (!movingBounds_.isEmpty()) view.longestArrow = kLongestArrow * movingBounds_.diagonal().norm();
  for (const ArrowPlace& place : arrowPlaces_) {
    const ShownPush& push = pushes_[place.push];
    if (push.isTorque) {
      const Vec3 size = Vec3::Constant(view.arcRadius(push));
      shown.push_back({Bounds(-size, size), size.x(), {Quat::Identity(), place.point}});
      view.bounds.extend(Bounds(place.point - size, place.point + size));
      continue;
    }
    const Vec3 tail = place.point - view.arrowLength(push) * push.force.normalized();
    for (const Vec3& end : {tail, place.point}) {
      shown.push_back({Bounds(Vec3::Zero(), Vec3::Zero()), 0, {Quat::Identity(), end}});
      view.bounds.extend(end);
    }
  }
}

Camera Framing::automaticCamera(const std::vector<Solid>& others) const {
  const Candidate& seen = bestCandidate();
  Reach reach = seen.moving;
  for (const Solid& solid : others) reach.include(reachOf(seen, solid));
  if (!std::isfinite(reach.right)) reach = {1, 1, 1, 1};

  // Inside the picture: right <= x + tan z and left <= -x + tan z for a camera at (x, y, z) in the axes of view.
  const double x = (reach.right - reach.left) / 2, y = (reach.top - reach.bottom) / 2;
  const double z = std::max((reach.right + reach.left) / (2 * tanHalfX_), (reach.top + reach.bottom) / (2 * tanHalfY_));
  const double depth = std::max({reach.right + reach.left, reach.top + reach.bottom, kSmallestReach});
  Camera camera;
  camera.position = seen.axes * Vec3(x, y, z + kSmallestReach);
  camera.target = camera.position - depth * seen.axes.col(2);
  camera.verticalFieldOfView = kFieldOfView;
  return camera;
}

View Framing::view() const {
  CRADLE_CHECK(start_.has_value() == scene_.camera.has_value());
  View view;
  view.bounds = movingBounds_;
  view.pushes = pushes_;
  std::vector<Solid> shown;
  for (const Solid& solid : solidsOf(placeBodiesAtStart(scene_), false)) {
    const Bounds bounds = transformed(solid.local, solid.worldFromLocal);
    const double limit = kLargestFixed * movingBounds_.diagonal().norm();
    if (!movingBounds_.isEmpty() && bounds.diagonal().norm() > limit) continue;
    shown.push_back(solid);
    view.bounds.extend(bounds);
  }
  if (start_) {
    lookFromScene(view);
  } else {
    includeArrows(view, shown);
    view.bounds.extend(motorArrowBounds_);
    view.camera = automaticCamera(shown);
  }
  return view;
}

}  // namespace cradle
