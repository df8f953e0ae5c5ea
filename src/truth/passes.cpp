#include "truth/passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr std::array<Pass, 7> kPasses = {Pass::rgb,  Pass::depth,        Pass::normal,           Pass::segmentation,
                                         Pass::flow, Pass::backwardFlow, Pass::objectCoordinates};
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr double kSamePlace = 1e-9;  // pixels: rounding of what does not move
constexpr double kSameDepth =
    1e-9;  // relative: a ray to a point of a surface meets that surface there, but for rounding

/// The number of surfaces of bodies, which come before those of links.
std::size_t bodySurfaces(const std::vector<SeenSurface>& surfaces) {
  const auto firstLink =
      std::find_if(surfaces.begin(), surfaces.end(), [](const SeenSurface& surface) { return surface.body == kWorld; });
  return static_cast<std::size_t>(firstLink - surfaces.begin());
}

void putVector(const Vec3& vector, std::size_t pixel, std::vector<float>& numbers) {
  for (std::size_t i = 0; i < 3; ++i) numbers[3 * pixel + i] = static_cast<float>(vector[static_cast<Eigen::Index>(i)]);
}

/// Calls visit(pixel's number, its centre, what is seen there).
template <class Visit>
void visitPixels(FrameRays& frame, const Visit& visit) {
  const std::vector<SeenPoint>& seen = frame.seen();
  std::size_t pixel = 0;
  for (int row = 0; row < frame.pinhole().height(); ++row)
    for (int column = 0; column < frame.pinhole().width(); ++column, ++pixel)
      visit(pixel, Eigen::Vector2d(column + 0.5, row + 0.5), seen[pixel]);
}

/// Shares of a triangle's corners at a point of its plane.
Vec3 sharesAt(const std::array<Vec3, 3>& corners, const Vec3& point) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  Vec3 shares;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &from = corners[static_cast<std::size_t>((i + 1) % 3)],
               &to = corners[static_cast<std::size_t>((i + 2) % 3)];
    shares[i] = normal.dot((to - from).cross(point - from)) / normal.squaredNorm();
  }
  return shares;
}

/// Takes coordinates in the camera of a frame to those in another's.
struct CameraMap {
  Mat3 matrix = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
  Vec3 operator*(const Vec3& point) const { return matrix * point + shift; }
};

CameraMap mapOf(const RigidTransform& worldMotion, const Pinhole& from, const Pinhole& to) {
  return {to.worldFromCamera().transpose() * worldMotion.rotation.toRotationMatrix() * from.worldFromCamera(),
          to.inCamera(worldMotion * from.position())};
}

/// How the points of a link's surface, triangles apart, move. A rod does not turn about itself, and what is at its ends
/// goes with them.
CameraMap mapOfLink(const SeenSurface& surface, const SeenSurface& moved, const Pinhole& from, const Pinhole& to) {
  const RigidTransform &place = surface.worldFromShape, &otherPlace = moved.worldFromShape;
  const Vec3 axis = place.rotation * Vec3::UnitY(), otherAxis = otherPlace.rotation * Vec3::UnitY();
  const Quat turn = rotationBetween(axis, otherAxis);
  return mapOf({turn, otherPlace.translation - turn * place.translation}, from, to);
}

/// How what is seen in a frame moves to another one.
class PointMotion {
 public:
  PointMotion(const FrameRays& frame, const FrameRays& other);

  /// Whether it is where it was, and so is the camera.
  bool isStill(const SeenPoint& seen) const {
    return isCameraStill_ && (seen.isSky() || isStill_[static_cast<std::size_t>(seen.surface)]);
  }

  /// Where a point (camera's coordinates) is in the other frame, and its camera; of the sky, a direction.
  Vec3 moved(const SeenPoint& seen, const Vec3& point) const {
    if (seen.isSky()) return sky_ * point;
    const std::size_t index = static_cast<std::size_t>(seen.surface);
    return bends_[index] ? movedOnTube(seen, point) : maps_[index] * point;
  }

 private:
  Vec3 movedOnTube(const SeenPoint& seen, const Vec3& point) const;
  std::size_t inOther(std::size_t surface) const { return surface - firstLink_ + otherFirstLink_; }

  const FrameRays &frame_, &other_;
  std::size_t firstLink_, otherFirstLink_;  // of the surfaces
  Mat3 sky_;
  std::vector<CameraMap> maps_;  // of each surface
  std::vector<char> bends_;      // of each surface: a tube
  std::vector<char> isStill_;    // of each surface
  bool isCameraStill_;
};

PointMotion::PointMotion(const FrameRays& frame, const FrameRays& other)
    : frame_(frame),
      other_(other),
      firstLink_(bodySurfaces(frame.surfaces())),
      otherFirstLink_(bodySurfaces(other.surfaces())),
      sky_(other.pinhole().worldFromCamera().transpose() * frame.pinhole().worldFromCamera()),
      isCameraStill_(frame.pinhole().position() == other.pinhole().position() &&
                     frame.pinhole().worldFromCamera() == other.pinhole().worldFromCamera()) {
  for (std::size_t i = 0; i < frame.surfaces().size(); ++i) {
    const SeenSurface& surface = frame.surfaces()[i];
    const bool isLink = i >= firstLink_;
    bends_.push_back(isLink && std::holds_alternative<WorldTriangles>(surface.shape));
    isStill_.push_back(0);
    if (bends_.back()) {
      maps_.emplace_back();
    } else if (isLink) {
      maps_.push_back(mapOfLink(surface, other.surfaces()[inOther(i)], frame.pinhole(), other.pinhole()));
    } else {
      const std::size_t body = static_cast<std::size_t>(surface.body);
      const RigidTransform &now = frame.worldFromBody()[body], &then = other.worldFromBody()[body];
      isStill_.back() = now.translation == then.translation && now.rotation.coeffs() == then.rotation.coeffs();
      const RigidTransform motion = then * now.inverse();
      maps_.push_back(mapOf(motion, frame.pinhole(), other.pinhole()));
    }
  }
}

Vec3 PointMotion::movedOnTube(const SeenPoint& seen, const Vec3& point) const {
  const std::size_t index = static_cast<std::size_t>(seen.surface);
  const auto& tube = std::get<WorldTriangles>(frame_.surfaces()[index].shape);
  const auto& other = std::get<WorldTriangles>(other_.surfaces()[inOther(index)].shape);
  const Triangle& corners = (*tube.triangles)[static_cast<std::size_t>(seen.triangle)];
  const Vec3 shares = sharesAt({tube.vertices[corners[0]], tube.vertices[corners[1]], tube.vertices[corners[2]]},
                               frame_.pinhole().inWorld(point));
  Vec3 moved = Vec3::Zero();
  for (std::size_t i = 0; i < 3; ++i) moved += shares[static_cast<Eigen::Index>(i)] * other.vertices[corners[i]];
  return other_.pinhole().inCamera(moved);
}

/// Whether what is seen at a depth (m) stands behind what is seen first there.
bool isCovered(const SeenPoint& seen, double depth, const SeenPoint& first) {
  return seen.isSky() ? !first.isSky() : first.depth < depth * (1 - kSameDepth);
}

/// Whether a point (camera's coordinates) that is at `place` in the picture cannot be seen there. `pixel` is the one in
/// whose centre it was in another frame.
bool isHidden(const SeenPoint& seen, const Vec3& point, const Eigen::Vector2d& place, const Eigen::Vector2d& centre,
              std::size_t pixel, FrameRays& frame) {
  if (place.x() < 0 || place.y() < 0 || place.x() > frame.pinhole().width() || place.y() > frame.pinhole().height())
    return true;
  const SeenPoint first = place == centre ? frame.seen()[pixel] : frame.rays().seenAt(place.x(), place.y());
  return isCovered(seen, point.z(), first);
}

}  // namespace

const char* nameOf(Pass pass) {
  switch (pass) {
    case Pass::rgb:
      return "rgb";
    case Pass::depth:
      return "depth";
    case Pass::normal:
      return "normal";
    case Pass::segmentation:
      return "segmentation";
    case Pass::flow:
      return "flow";
    case Pass::backwardFlow:
      return "backwardFlow";
    case Pass::objectCoordinates:
      return "objectCoordinates";
  }
  return "";
}

std::vector<Pass> parsePasses(const std::string& text) {
  if (text == "all") return {kPasses.begin(), kPasses.end()};
  std::vector<Pass> passes;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    const auto pass = std::find_if(kPasses.begin(), kPasses.end(), [&](Pass known) { return name == nameOf(known); });
    if (pass == kPasses.end())
      throw Error(ErrorKind::usage, "--passes",
                  fmt::format("found \"{}\"; allowed are rgb, depth, normal, segmentation, flow, backwardFlow and "
                              "objectCoordinates, with commas, or all",
                              name));
    if (std::find(passes.begin(), passes.end(), *pass) == passes.end()) passes.push_back(*pass);
    begin = end + 1;
  }
  return passes;
}

FrameRays::FrameRays(const SurfaceSource& source, const Frame& frame, std::vector<RigidTransform> worldFromBody,
                     const Pinhole& pinhole)
    : pinhole_(pinhole),
      worldFromBody_(std::move(worldFromBody)),
      surfaces_(source.at(frame, pinhole.position())),
      rays_(surfaces_, pinhole_) {}

void FrameRays::findSeen() {
  if (!seen_.empty()) return;
  wholes_.resize(worldFromBody_.size());
  seen_ = rays_.seenPoints(wholes_);
}

const std::vector<SeenPoint>& FrameRays::seen() {
  findSeen();
  return seen_;
}

const std::vector<WholeExtent>& FrameRays::wholes() {
  findSeen();
  return wholes_;
}

std::vector<float> depthPass(FrameRays& frame) {
  std::vector<float> depths;
  depths.reserve(frame.seen().size());
  for (const SeenPoint& seen : frame.seen()) depths.push_back(static_cast<float>(seen.depth));
  return depths;
}

std::vector<float> normalPass(FrameRays& frame, const Quat& outFromWorld) {
  std::vector<float> normals(3 * frame.seen().size(), kNone);
  const Mat3 turn = outFromWorld.toRotationMatrix();
  visitPixels(frame, [&](std::size_t pixel, const Eigen::Vector2d& centre, const SeenPoint& seen) {
    if (!seen.isSky()) putVector(turn * frame.rays().normalAt(centre.x(), centre.y(), seen), pixel, normals);
  });
  return normals;
}

std::vector<std::uint16_t> segmentationPass(FrameRays& frame) {
  std::vector<std::uint16_t> ids = {0};  // of the sky, and of each surface
  for (const SeenSurface& surface : frame.surfaces()) {
    const int id = surface.link ? kFirstLinkId + static_cast<int>(*surface.link) : surface.body + 1;
    ids.push_back(static_cast<std::uint16_t>(id));
  }
  std::vector<std::uint16_t> segmentation;
  segmentation.reserve(frame.seen().size());
  for (const SeenPoint& seen : frame.seen()) segmentation.push_back(ids[static_cast<std::size_t>(seen.surface + 1)]);
  return segmentation;
}

std::vector<float> objectCoordinatesPass(FrameRays& frame) {
  std::vector<std::optional<CameraMap>> bodyFromCamera;  // of each surface of a body
  for (const SeenSurface& surface : frame.surfaces()) {
    if (surface.body == kWorld) {
      bodyFromCamera.emplace_back();
      continue;
    }
    const RigidTransform bodyFromWorld = frame.worldFromBody()[static_cast<std::size_t>(surface.body)].inverse();
    bodyFromCamera.push_back(CameraMap{bodyFromWorld.rotation.toRotationMatrix() * frame.pinhole().worldFromCamera(),
                                       bodyFromWorld * frame.pinhole().position()});
  }
  std::vector<float> coordinates(3 * frame.seen().size(), kNone);
  visitPixels(frame, [&](std::size_t pixel, const Eigen::Vector2d& centre, const SeenPoint& seen) {
    if (seen.isSky()) return;
    const auto& map = bodyFromCamera[static_cast<std::size_t>(seen.surface)];
    if (map) putVector(*map * (seen.depth * frame.pinhole().rayAt(centre.x(), centre.y())), pixel, coordinates);
  });
  return coordinates;
}

Flow flowPass(FrameRays& frame, FrameRays& other, bool findsHidden) {
  const PointMotion motion(frame, other);
  Flow flow{std::vector<float>(2 * frame.seen().size(), kNone), {}};
  if (findsHidden) flow.isHidden.assign(frame.seen().size(), 1);
  visitPixels(frame, [&](std::size_t pixel, const Eigen::Vector2d& centre, const SeenPoint& seen) {
    if (motion.isStill(seen)) {
      flow.shift[2 * pixel] = flow.shift[2 * pixel + 1] = 0;
      if (findsHidden && !isCovered(seen, seen.depth, other.seen()[pixel])) flow.isHidden[pixel] = 0;
      return;
    }
    const Vec3 ray = frame.pinhole().rayAt(centre.x(), centre.y());
    const Vec3 moved = motion.moved(seen, seen.isSky() ? ray : Vec3(seen.depth * ray));
    auto place = other.pinhole().project(moved);
    if (!place) return;
    if ((*place - centre).squaredNorm() < kSamePlace * kSamePlace) place = centre;
    flow.shift[2 * pixel] = static_cast<float>(place->x() - centre.x());
    flow.shift[2 * pixel + 1] = static_cast<float>(place->y() - centre.y());
    if (findsHidden && !isHidden(seen, moved, *place, centre, pixel, other)) flow.isHidden[pixel] = 0;
  });
  return flow;
}

}  // namespace cradle
