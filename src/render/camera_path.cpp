// Key frames: cubic Hermite curves, number by number, with the slopes of F. N. Fritsch and J. Butland ("A method for
// constructing local monotone piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5(2), 1984): once continuously
// differentiable, and never beyond the two keys on either side, so that equal keys stand still and no field of view is
// out of range. Slopes at the ends are 0, for the camera rests before and after.
//
// Following: the camera hangs on a critically damped spring, s'' = w^2 (c - s) - 2 w s', behind a body at c that moves
// evenly from frame to frame. With e = c - s and u = c', e'' + 2 w e' + w^2 e = 2 w u, solved by
// e = 2 u / w + (A + B t) exp(-w t): behind a body of constant speed it stays back by 2 u / w, the lag's way.

#include "render/camera_path.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "math/elementary.h"
#include "math/rotation.h"
#include "render/body_place.h"
#include "render/inside_body.h"
#include "scene/fault_list.h"

namespace cradle {
namespace {

using Key = CameraMotion::Key;
using KeyNumbers = Eigen::Matrix<double, 7, 1>;  // position, target, field of view

KeyNumbers numbersOf(const Key& key) {
  KeyNumbers numbers;
  numbers << key.position, key.target, key.verticalFieldOfView;
  return numbers;
}

/// Change per second from key i to the next.
KeyNumbers secant(const std::vector<Key>& keys, std::size_t i) {
  return (numbersOf(keys[i + 1]) - numbersOf(keys[i])) / (keys[i + 1].time - keys[i].time);
}

/// Slopes at key i: harmonic means of the secants beside it, weighted; 0 where these differ in sign.
KeyNumbers slopeAt(const std::vector<Key>& keys, std::size_t i) {
  KeyNumbers slope = KeyNumbers::Zero();
  if (i == 0 || i + 1 == keys.size()) return slope;
  const KeyNumbers before = secant(keys, i - 1), after = secant(keys, i);
  const double spanBefore = keys[i].time - keys[i - 1].time, spanAfter = keys[i + 1].time - keys[i].time;
  const double share = (spanBefore + 2 * spanAfter) / (3 * (spanBefore + spanAfter));
  for (Eigen::Index n = 0; n < slope.size(); ++n)
    if (before[n] * after[n] > 0) slope[n] = before[n] * after[n] / (share * after[n] + (1 - share) * before[n]);
  return slope;
}

KeyNumbers interpolated(const std::vector<Key>& keys, double time) {
  if (time <= keys.front().time) return numbersOf(keys.front());
  std::size_t i = 0;
  while (i + 1 < keys.size() && keys[i + 1].time <= time) ++i;
  if (i + 1 == keys.size()) return numbersOf(keys.back());
  const double span = keys[i + 1].time - keys[i].time, s = (time - keys[i].time) / span;
  const KeyNumbers change = numbersOf(keys[i + 1]) - numbersOf(keys[i]);
  return numbersOf(keys[i]) + s * s * (3 - 2 * s) * change +
         span * s * (1 - s) * ((1 - s) * slopeAt(keys, i) - s * slopeAt(keys, i + 1));
}

/// Centre of mass of a dynamic body, else the origin of its frame (m, world).
Vec3 middleOf(const Scene& scene, int body, const std::vector<RigidTransform>& worldFromBody) {
  const auto index = static_cast<std::size_t>(body);
  const Body& found = scene.bodies.at(index);
  return worldFromBody.at(index) *
         (found.motion == Motion::dynamic ? found.massProperties.centerOfMass : Vec3(Vec3::Zero()));
}

}  // namespace

CameraPath::CameraPath(const Scene& scene) : scene_(scene), motion_(scene.cameraMotion) {
  CRADLE_CHECK(scene.camera.has_value());
  for (const Body& body : scene.bodies) localBounds_.push_back(localBounds(scene, body));
}

/// One step of the spring, which starts at rest with the body in its place.
void CameraPath::follow(double time, const Vec3& leader) {
  if (!hasStarted_) {
    leaderStart_ = leader_ = leader;
    behind_ = Vec3::Zero();
    return;
  }
  const double step = time - time_;
  const Vec3 u = (leader - leader_) / step;
  leader_ = leader;
  if (motion_.follow->lag == 0) return;
  const double w = 2 / motion_.follow->lag;  // rad/s
  const Vec3 steady = 2 / w * u;
  const Vec3 a = behind_ - steady, b = u - velocity_ + w * a;
  const double decay = exp(-w * step);
  behind_ = steady + decay * (a + step * b);
  velocity_ = u - decay * (b - w * (a + step * b));
}

Camera CameraPath::next(double time, const std::vector<RigidTransform>& worldFromBody) {
  Camera camera = *scene_.camera;
  if (!motion_.keys.empty()) {
    const KeyNumbers now = interpolated(motion_.keys, time);
    camera.position = now.head<3>();
    camera.target = now.segment<3>(3);
    camera.verticalFieldOfView = now[6];
  }
  if (motion_.follow) {
    follow(time, middleOf(scene_, motion_.follow->body, worldFromBody));
    const Vec3 moved = leader_ - behind_ - leaderStart_;
    camera.position += moved;
    camera.target += moved;
  }
  if (motion_.targetBody != kWorld) camera.target = middleOf(scene_, motion_.targetBody, worldFromBody);
  if (motion_.orbitPeriod) {
    const double turns = time / *motion_.orbitPeriod;
    const Quat turn = rotationAbout(camera.up, 2 * std::numbers::pi * (turns - std::floor(turns)));
    camera.position = camera.target + turn * (camera.position - camera.target);
  }
  hasStarted_ = true;
  time_ = time;
  requireUsable(camera, time, worldFromBody);
  return camera;
}

void CameraPath::requireUsable(const Camera& camera, double time,
                               const std::vector<RigidTransform>& worldFromBody) const {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::scene, camera.where, fmt::format("at {:.6g} s the camera {}", time, what));
  };
  if (camera.position == camera.target) refuse("is where it looks; they must differ, or there is no way to look");
  if (looksAlongUp(camera))
    refuse("looks along its up vector; allowed is any other direction; change its way, or \"up\"");
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const Vec3 place = worldFromBody[i].inverse() * camera.position;
    if (localBounds_[i].contains(place) && isInside(scene_, scene_.bodies[i], place))
      refuse(fmt::format("is inside body {}; allowed is any place outside all bodies, from start to end",
                         inQuotes(scene_.bodies[i].name)));
  }
}

FilmCamera::FilmCamera(const Scene& scene, const Camera& still, std::function<Frame(long)> frameAt)
    : scene_(scene), frameAt_(std::move(frameAt)), camera_(still) {}

const Camera& FilmCamera::at(const Frame& frame) {
  if (!scene_.camera || frame.number + 1 == next_) return camera_;
  if (!path_ || frame.number < next_) {
    path_.emplace(scene_);
    next_ = 0;
  }
  const auto follow = [this](const Frame& next) { camera_ = path_->next(next.time, placeBodies(scene_, next)); };
  while (next_ < frame.number) follow(frameAt_(next_)), ++next_;
  follow(frame);
  next_ = frame.number + 1;
  return camera_;
}

void requireUsableCamera(const Scene& scene) {
  if (scene.camera) CameraPath(scene).next(0, placeBodiesAtStart(scene));
}

}  // namespace cradle
