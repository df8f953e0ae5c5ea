#include "verify/check_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "verify/placed_solid.h"
#include "verify/single_precision.h"

namespace cradle {
namespace {

constexpr double kSingleRatio = 1.2e-7;  // as in check_surfaces.cpp
constexpr double kDoubleRatio = 4e-15;   // a dozen operations
constexpr double kStandingStill = 1e-9;  // pixels: what moves by less than this is written as what does not
constexpr double kSurelyBefore = 1e-5;   // of the depth: what the rounding of a place changes on a slanted surface
constexpr double kEdgeShare = 0.01;      // of the pixels of an id that may be in parts thinner than a pixel
constexpr double kTouchingShare = 1e-4;  // of the pixels of a frame that may be where one thing just hides another
constexpr double kFewPixels = 4;         // that may be so in any case

/// A picture's pixels one by one: how many there are, how many are not as they should be, and the first of those.
struct PixelCount {
  long values = 0, faults = 0;
  std::optional<Fault> first;

  template <class Describe>
  void add(bool holds, const Describe& describe) {
    ++values;
    if (holds) return;
    ++faults;
    if (!first) first = describe();
  }

  /// A share of `ofValues` of them may be wrong.
  void report(Aspect aspect, double share, long ofValues, Findings& findings) const {
    if (values == 0) return;
    const double allowed = std::max(share * static_cast<double>(ofValues), kFewPixels);
    findings.add(
        aspect, static_cast<double>(faults), allowed, [&] { return *first; }, values, faults);
  }
};

/// Where something is in another frame.
struct Destination {
  double depth = 0;                                 // m
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // pixels
  bool isInFront = false, isSure = true;            // not sure: rounding decides whether it is in front
  double tolerance = 0;                             // pixels
};

/// A pixel and its centre, in pixel coordinates.
struct MovingPixel {
  std::size_t pixel;
  int x, y;
  Eigen::Vector2d centre;
};

/// A frame beside the one at hand.
struct Neighbour {
  long number;
  TruthCamera camera;
  std::vector<RigidTransform> worldFromBody;
};

/// What a file says of a pixel's flow (pixels).
struct FlowAt {
  FoundPlace place;
  Eigen::Vector2d shift;
};

std::string wordsOfShift(const Eigen::Vector2d& shift) {
  return fmt::format("[{:.9g} {:.9g}]", shift.x(), shift.y());
}

class MotionCheck {
 public:
  MotionCheck(const VerifiedFilm& film, const TruthFrame& frame, const TruthFrame* next, Findings& findings)
      : film_(film),
        frame_(frame),
        next_(next),
        camera_(film.cameras.frames[static_cast<std::size_t>(frame.number)]),
        depths_(knownDepths()),
        findings_(findings) {}

  void checkFlow(const std::vector<float>& flow, const char* kind, Aspect aspect, long other);
  void checkHidden();
  void checkReprojection();

 private:
  std::vector<double> knownDepths() const;
  std::optional<Neighbour> neighbourAt(long number) const;
  template <class Visit>
  void visitPixels(const Visit& visit) const;
  template <class Visit>
  void visitMoved(const Neighbour& to, const Visit& visit) const;
  bool isFollowed(std::size_t pixel) const;
  bool isOfMesh(int id) const {
    return id > 0 && std::holds_alternative<ModelShape>(film_.scene.bodies[static_cast<std::size_t>(id - 1)].shape);
  }
  bool rests(std::size_t pixel, const Neighbour& other) const;
  Destination skyIn(const TruthCamera& to, const Vec3& ray) const;
  Destination destinationOf(std::size_t pixel, const Eigen::Vector2d& centre, const Neighbour& to) const;
  void expectNone(const FlowAt& found, Aspect aspect, const char* expected);
  std::optional<bool> agreesWithNext(int id, const Destination& destination) const;

  const VerifiedFilm& film_;
  const TruthFrame& frame_;
  const TruthFrame* next_;
  const TruthCamera camera_;
  const std::vector<double> depths_;  // m, of each pixel
  Findings& findings_;
};

/// Nothing if the trajectory has no such frame.
std::optional<Neighbour> MotionCheck::neighbourAt(long number) const {
  if (!film_.hasFrame(number)) return std::nullopt;
  return Neighbour{number, TruthCamera(film_.cameras.frames[static_cast<std::size_t>(number)]),
                   posesOf(film_.scene, film_.trajectory.readFrame(number))};
}

template <class Visit>
void MotionCheck::visitPixels(const Visit& visit) const {
  std::size_t pixel = 0;
  for (int y = 0; y < film_.cameras.height; ++y)
    for (int x = 0; x < film_.cameras.width; ++x, ++pixel) visit(MovingPixel{pixel, x, y, {x + 0.5, y + 0.5}});
}

/// Depths (m) as the folder says, else of the forms of bodies; NaN where neither does.
std::vector<double> MotionCheck::knownDepths() const {
  if (!frame_.depth.empty()) return {frame_.depth.begin(), frame_.depth.end()};
  std::vector<double> depths(frame_.ids.size(), std::numeric_limits<double>::quiet_NaN());
  std::map<int, PlacedSolid> solids;  // by id
  for (const PlacedSolid& solid : solidsOf(film_.scene, frame_.worldFromBody, camera_.position()))
    solids.emplace(solid.body() + 1, solid);
  visitPixels([&](const MovingPixel& at) {
    const auto solid = solids.find(frame_.ids[at.pixel]);
    if (solid == solids.end()) return;
    const auto range = solid->second.meet({camera_.position(), camera_.rayAt(at.centre.x(), at.centre.y())});
    if (range && range->isSure) depths[at.pixel] = range->middle();
  });
  return depths;
}

/// Whether it is known where a pixel's point goes: the sky's, and a body's at a known depth.
bool MotionCheck::isFollowed(std::size_t pixel) const {
  const int id = frame_.ids[pixel];
  const bool isBody = id > 0 && id <= static_cast<int>(film_.scene.bodies.size());
  return id == 0 || (isBody && std::isfinite(depths_[pixel]));
}

Destination MotionCheck::skyIn(const TruthCamera& to, const Vec3& ray) const {
  const Vec3 seen = to.seenDirection(ray);
  Destination destination{seen.z(), seen.hnormalized(), seen.z() > 0, std::abs(seen.z()) > kDoubleRatio, 0};
  destination.tolerance = kDoubleRatio * (to.focal() + destination.place.norm()) / std::abs(seen.z());
  return destination;
}

Destination MotionCheck::destinationOf(std::size_t pixel, const Eigen::Vector2d& centre, const Neighbour& to) const {
  const int id = frame_.ids[pixel];
  const Vec3 ray = camera_.rayAt(centre.x(), centre.y());
  if (id == 0) return skyIn(to.camera, ray);
  const std::size_t body = static_cast<std::size_t>(id - 1);
  const RigidTransform &from = frame_.worldFromBody[body], &at = to.worldFromBody[body];
  const auto seenAt = [&](double depth) {
    const Vec3 point = camera_.position() + depth * ray;
    const Vec3 local = from.rotation.toRotationMatrix().transpose() * (point - from.translation);
    return to.camera.seen(at.rotation.toRotationMatrix() * local + at.translation);
  };
  const Vec3 seen = seenAt(depths_[pixel]), farther = seenAt(depths_[pixel] * (1 + kSingleRatio));
  const double size = camera_.position().norm() + to.camera.position().norm() + depths_[pixel] * ray.norm() +
                      from.translation.norm() + at.translation.norm();
  Destination destination{seen.z(), seen.hnormalized(), seen.z() > 0, true, 0};
  destination.isSure = std::abs(seen.z()) > 2 * std::abs(farther.z() - seen.z()) + kDoubleRatio * size;
  destination.tolerance = (farther.hnormalized() - destination.place).norm() +
                          kDoubleRatio * size * (to.camera.focal() + destination.place.norm()) / std::abs(seen.z());
  return destination;
}

/// Whether what a pixel shows is at the same place in another frame, and seen by the same camera.
bool MotionCheck::rests(std::size_t pixel, const Neighbour& other) const {
  const CameraRecord &a = film_.cameras.frames[static_cast<std::size_t>(frame_.number)],
                     &b = film_.cameras.frames[static_cast<std::size_t>(other.number)];
  if (a.intrinsics != b.intrinsics || a.worldFromCameraOpenCv != b.worldFromCameraOpenCv) return false;
  if (frame_.ids[pixel] == 0) return true;
  const std::size_t body = static_cast<std::size_t>(frame_.ids[pixel] - 1);
  const RigidTransform &here = frame_.worldFromBody[body], &there = other.worldFromBody[body];
  return here.translation == there.translation && here.rotation.coeffs() == there.rotation.coeffs();
}

void MotionCheck::checkFlow(const std::vector<float>& flow, const char* kind, Aspect aspect, long other) {
  if (flow.empty()) return;
  const auto to = neighbourAt(other);
  visitPixels([&](const MovingPixel& at) {
    const FlowAt found{{frame_.fileOf(kind), at.x, at.y},
                       {static_cast<double>(flow[2 * at.pixel]), static_cast<double>(flow[2 * at.pixel + 1])}};
    if (!to) return expectNone(found, aspect, "NaN, for there is no such frame");
    if (!isFollowed(at.pixel)) return;
    const Destination destination = destinationOf(at.pixel, at.centre, *to);
    if (!destination.isSure) return;
    if (!destination.isInFront) return expectNone(found, aspect, "NaN, for it is behind the camera");
    const bool isStill = rests(at.pixel, *to);
    const Eigen::Vector2d expected = isStill ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(destination.place - at.centre);
    const double tolerance = isStill ? 0 : destination.tolerance + kSingleRatio * expected.norm() + kStandingStill;
    findings_.add(aspect, (found.shift - expected).norm(), tolerance, [&] {
      return Fault{found.place, wordsOfShift(found.shift),
                   fmt::format("{} of id {}", wordsOfShift(expected), frame_.ids[at.pixel])};
    });
  });
}

void MotionCheck::expectNone(const FlowAt& found, Aspect aspect, const char* expected) {
  findings_.add(aspect, found.shift.array().isNaN().all() ? 0 : 1, kStandingStill, [&] {
    return Fault{found.place, wordsOfShift(found.shift), expected};
  });
}

/// Calls visit(pixel, destination) for what is followed to before the camera of another frame.
template <class Visit>
void MotionCheck::visitMoved(const Neighbour& to, const Visit& visit) const {
  visitPixels([&](const MovingPixel& at) {
    if (!isFollowed(at.pixel)) return;
    const Destination destination = destinationOf(at.pixel, at.centre, to);
    if (destination.isInFront && destination.isSure) visit(at, destination);
  });
}

/// What is before a depth (m) on a ray, of all bodies or of one: for certain, or, for all that rounding may do,
/// perhaps.
struct Before {
  bool surely = false, perhaps = false;
};

Before findBefore(const std::vector<PlacedSolid>& solids, const PictureRay& ray, double depth,
                  std::optional<int> body = {}) {
  Before before;
  for (const PlacedSolid& solid : solids) {
    if (body && solid.body() != *body) continue;
    const auto range = solid.meet(ray);
    if (!range) continue;
    before.surely = before.surely || (range->isSure && range->most < depth * (1 - kSurelyBefore));
    before.perhaps = before.perhaps || range->least < depth * (1 - kSurelyBefore);
  }
  return before;
}

/// What is hidden is beside the picture, or, if bodies without other forms are all that there is, behind one of them;
/// what is not is in the picture, with no body before it.
void MotionCheck::checkHidden() {
  if (frame_.hidden.empty()) return;
  PixelCount count;
  const auto add = [&](bool holds, const MovingPixel& at, const char* found, const char* expected) {
    count.add(holds, [&] { return Fault{{frame_.fileOf("hidden"), at.x, at.y}, found, expected}; });
  };
  const auto to = neighbourAt(frame_.number + 1);
  if (!to) {
    return visitPixels([&](const MovingPixel& at) {
      findings_.add(Aspect::hidden, frame_.hidden[at.pixel] == 1 ? 0 : 1, 0, [&] {
        return Fault{{frame_.fileOf("hidden"), at.x, at.y}, "0", "1, for there is no next frame"};
      });
    });
  }
  const auto solids = solidsOf(film_.scene, to->worldFromBody, to->camera.position());
  const bool knowsAll = hasSolidsAlone(film_.scene);
  const Eigen::AlignedBox2d picture(Eigen::Vector2d::Zero(), Eigen::Vector2d(static_cast<double>(film_.width()),
                                                                             static_cast<double>(film_.height())));
  visitMoved(*to, [&](const MovingPixel& at, const Destination& moved) {
    const double depth = frame_.ids[at.pixel] == 0 ? std::numeric_limits<double>::infinity() : moved.depth;
    const PictureRay ray{to->camera.position(), to->camera.rayAt(moved.place.x(), moved.place.y())};
    const Before before = findBefore(solids, ray, depth);
    const bool isBeside = picture.exteriorDistance(moved.place) > moved.tolerance + kStandingStill;
    if (frame_.hidden[at.pixel] == 0)
      add(!isBeside && !before.surely, at, "0", "1: it is beside the next picture, or behind a body");
    else if (knowsAll && picture.contains(moved.place))
      add(before.perhaps, at, "1", "0: no body is before it in the next frame");
  });
  count.report(Aspect::hidden, kTouchingShare, count.values, findings_);
}

/// Whether the pixels around a place in the next frame show an id at a depth; nothing where they do not all show one,
/// or all a link: between its wires, if they are thinner than a pixel, the other may be seen.
std::optional<bool> MotionCheck::agreesWithNext(int id, const Destination& moved) const {
  const long column = static_cast<long>(std::floor(moved.place.x())),
             row = static_cast<long>(std::floor(moved.place.y()));
  if (column < 1 || row < 1 || column + 1 >= film_.cameras.width || row + 1 >= film_.cameras.height)
    return std::nullopt;
  const auto at = [&](long x, long y) { return static_cast<std::size_t>(y * film_.cameras.width + x); };
  const int shown = next_->ids[at(column, row)];
  double least = std::numeric_limits<double>::infinity(), most = 0;  // m, of depths
  for (long y = row - 1; y <= row + 1; ++y)
    for (long x = column - 1; x <= column + 1; ++x) {
      if (next_->ids[at(x, y)] != shown || shown == kUnknownId) return std::nullopt;
      if (next_->depth.empty()) continue;
      least = std::min(least, static_cast<double>(next_->depth[at(x, y)]));
      most = std::max(most, static_cast<double>(next_->depth[at(x, y)]));
    }
  if (shown != id && shown >= kFirstIdOfLinks) return std::nullopt;
  if (shown != id) return false;
  const double slack = (most - least) + kSurelyBefore * moved.depth;  // a surface that bends between the centres
  return id == 0 || next_->depth.empty() || (moved.depth >= least - slack && moved.depth <= most + slack);
}

/// What is not hidden is what the next frame shows at its place. What is, is not; of meshes, which may hide themselves,
/// that is not known.
void MotionCheck::checkReprojection() {
  if (frame_.hidden.empty() || next_ == nullptr) return;
  std::map<int, PixelCount> counts;  // of what is not hidden, by id
  PixelCount hidden;                 // of what is
  long all = 0;
  const Neighbour to = *neighbourAt(frame_.number + 1);
  const auto solids = solidsOf(film_.scene, to.worldFromBody, to.camera.position());
  visitMoved(to, [&](const MovingPixel& at, const Destination& moved) {
    const int id = frame_.ids[at.pixel];
    const bool isHidden = frame_.hidden[at.pixel] != 0;
    if (isHidden && isOfMesh(id)) return;
    const auto agrees = agreesWithNext(id, moved);
    if (!agrees) return;
    const PictureRay ray{to.camera.position(), to.camera.rayAt(moved.place.x(), moved.place.y())};
    const bool isShown = *agrees && (!isHidden || !findBefore(solids, ray, moved.depth, id - 1).perhaps);
    const auto fault = [&] {
      return Fault{{frame_.fileOf("hidden"), at.x, at.y},
                   fmt::format("{}, and in the next frame {} at ({:.3f}, {:.3f})", isHidden ? 1 : 0,
                               isShown ? "the same" : "something else", moved.place.x(), moved.place.y()),
                   fmt::format("id {} at a depth of {:.9g} m there{}", id, moved.depth, isHidden ? " hidden" : "")};
    };
    (isHidden ? hidden : counts[id]).add(isShown != isHidden, fault);
    ++all;
  });
  for (const auto& [id, count] : counts) count.report(Aspect::reprojection, kEdgeShare, count.values, findings_);
  hidden.report(Aspect::reprojection, kEdgeShare, all, findings_);  // a rod across a small body hides a line of it
}

}  // namespace

void checkMotion(const VerifiedFilm& film, const TruthFrame& frame, const TruthFrame* next, Findings& findings) {
  MotionCheck check(film, frame, next, findings);
  check.checkFlow(frame.flow, "flow", Aspect::flow, frame.number + 1);
  check.checkFlow(frame.backwardFlow, "backwardFlow", Aspect::backwardFlow, frame.number - 1);
  check.checkHidden();
  check.checkReprojection();
}

}  // namespace cradle
