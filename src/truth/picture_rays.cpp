#include "truth/picture_rays.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/ray_cast.h"

namespace cradle {
namespace {

constexpr int kTile = 8;               // pixels a side
constexpr double kBoxMargin = 1e-6;    // pixels, beyond rounding of places in a picture
constexpr float kFacetMargin = 4e-3f;  // pixels, the same in single precision at 16384 pixels
constexpr double kMiss = std::numeric_limits<double>::infinity();

/// Half edges of the box around a round shape, in its frame; m.
Vec3 halfSize(const Sphere& sphere) {
  return Vec3::Constant(sphere.radius);
}
Vec3 halfSize(const Cylinder& cylinder) {
  return {cylinder.radius, cylinder.length / 2, cylinder.radius};
}
Vec3 halfSize(const Capsule& capsule) {
  return {capsule.radius, capsule.length / 2 + capsule.radius, capsule.radius};
}

/// Depth at which a ray, whose direction has a depth of 1, meets a shape; all in the shape's frame.
template <class Round>
double depthAlong(const Vec3& origin, const Vec3& direction, const Round& shape) {
  const double length = direction.norm();
  const std::optional<double> distance = castRay({origin, direction / length}, shape);
  return distance ? *distance / length : kMiss;
}
double depthAlong(const Vec3& origin, const Vec3& direction, const Plane& plane) {
  const double approach = plane.normal.dot(direction);
  return approach < 0 ? -plane.normal.dot(origin) / approach : kMiss;
}

/// A triangle as the camera sees it; camera's coordinates.
class SeenTriangle {
 public:
  explicit SeenTriangle(const std::array<Vec3, 3>& corners)
      : edges_{corners[1].cross(corners[2]), corners[2].cross(corners[0]), corners[0].cross(corners[1])},
        normal_((corners[1] - corners[0]).cross(corners[2] - corners[0])),
        height_(normal_.dot(corners[0])) {}

  /// An edge that two triangles share has the same numbers in both, but for the sign: a ray is inside of one of them.
  double depthAlong(const Vec3& ray) const {
    const double a = ray.dot(edges_[0]), b = ray.dot(edges_[1]), c = ray.dot(edges_[2]);
    const bool isInside = (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
    if (!isInside || height_ == 0) return kMiss;  // seen edge-on: its neighbours meet the ray
    const double depth = height_ / normal_.dot(ray);
    return depth > 0 ? depth : kMiss;
  }

  const Vec3& normal() const { return normal_; }

 private:
  std::array<Vec3, 3> edges_;
  Vec3 normal_;
  double height_;  // of the camera over its plane, times the length of the normal
};

std::array<Vec3, 3> cornersOf(const Triangle& triangle, const std::vector<Vec3>& vertices) {
  return {vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]};
}

/// Outward normals of round shapes at a point of their surface; their frames.
Vec3 normalOf(const Sphere&, const Vec3& point) {
  return point;
}
Vec3 normalOf(const Cylinder& cylinder, const Vec3& point) {
  const Vec3 across(point.x(), 0, point.z());
  const double fromCap = std::abs(std::abs(point.y()) - cylinder.length / 2);
  return fromCap < std::abs(across.norm() - cylinder.radius) ? Vec3(0, point.y(), 0) : across;
}
Vec3 normalOf(const Capsule& capsule, const Vec3& point) {
  return point - Vec3(0, std::clamp(point.y(), -capsule.length / 2, capsule.length / 2), 0);
}
Vec3 normalOf(const Plane& plane, const Vec3&) {
  return plane.normal;
}

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

PictureRays::PictureRays(const std::vector<SeenSurface>& surfaces, const Pinhole& pinhole)
    : surfaces_(surfaces),
      pinhole_(pinhole),
      tilesAcross_((pinhole.width() + kTile - 1) / kTile),
      tilesDown_((pinhole.height() + kTile - 1) / kTile) {
  for (const SeenSurface& surface : surfaces) {
    const RigidTransform shapeFromWorld = surface.worldFromShape.inverse();
    Prepared prepared{{},
                      shapeFromWorld * pinhole.position(),
                      shapeFromWorld.rotation.toRotationMatrix() * pinhole.worldFromCamera(),
                      {}};
    const auto includeBox = [&](const auto& shape) {
      std::array<Vec3, 8> corners;
      const Vec3 half = halfSize(shape);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3 corner((i & 1) != 0 ? half.x() : -half.x(), (i & 2) != 0 ? half.y() : -half.y(),
                          (i & 4) != 0 ? half.z() : -half.z());
        corners[i] = pinhole.inCamera(surface.worldFromShape * corner);
      }
      prepared.box = boxAround(corners.data(), corners.size());
    };
    std::visit(Overloaded{includeBox, [&](const Plane&) { prepared.box = boxAround(nullptr, 0); },
                          [&](const WorldTriangles& mesh) {
                            for (const Vec3& vertex : mesh.vertices)
                              prepared.vertices.push_back(pinhole.inCamera(vertex));
                          }},
               surface.shape);
    prepared_.push_back(std::move(prepared));
  }
}

/// Of points that are all in front of the camera; the whole picture if some are not, or there are none; empty if all
/// are behind it.
PictureBox PictureRays::boxAround(const Vec3* corners, std::size_t count) const {
  const PictureBox picture(Eigen::Vector2d::Zero(), Eigen::Vector2d(pinhole_.width(), pinhole_.height()));
  PictureBox box;
  std::size_t behind = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto place = pinhole_.project(corners[i]);
    if (place)
      box.extend(*place);
    else
      ++behind;
  }
  if (count > 0 && behind == count) return {};
  if (behind > 0 || count == 0) return picture;
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kBoxMargin);
  return PictureBox(box.min() - margin, box.max() + margin).intersection(picture);
}

/// Calls visit(surface or triangle as a function of the ray, index of the triangle or -1, box) for all facets of a
/// surface that may be in the picture.
template <class Visit>
void PictureRays::visitFacets(std::size_t surface, const Visit& visit) const {
  const Prepared& prepared = prepared_[surface];
  const auto visitRound = [&](const auto& shape) {
    if (prepared.box.isEmpty()) return;
    visit([&](const Vec3& ray) { return depthAlong(prepared.origin, prepared.shapeFromCamera * ray, shape); }, -1,
          prepared.box);
  };
  const auto visitTriangles = [&](const WorldTriangles& mesh) {
    for (std::size_t i = 0; i < mesh.triangles->size(); ++i) {
      const std::array<Vec3, 3> corners = cornersOf((*mesh.triangles)[i], prepared.vertices);
      const PictureBox box = boxAround(corners.data(), corners.size());
      if (box.isEmpty()) continue;
      const SeenTriangle triangle(corners);
      visit([&](const Vec3& ray) { return triangle.depthAlong(ray); }, static_cast<std::int32_t>(i), box);
    }
  };
  std::visit(Overloaded{visitRound, visitTriangles}, surfaces_[surface].shape);
}

/// Calls visit(x, y) for the pixels with their centres in a box.
template <class Visit>
void PictureRays::visitCentres(const PictureBox& box, const Visit& visit) const {
  const int left = static_cast<int>(std::ceil(box.min().x() - 0.5)),
            right = static_cast<int>(std::floor(box.max().x() - 0.5));
  const int top = static_cast<int>(std::ceil(box.min().y() - 0.5)),
            bottom = static_cast<int>(std::floor(box.max().y() - 0.5));
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) visit(x, y);
}

std::vector<SeenPoint> PictureRays::seenPoints(std::vector<WholeExtent>& wholes) const {
  const std::size_t pixels = static_cast<std::size_t>(pinhole_.width()) * static_cast<std::size_t>(pinhole_.height());
  std::vector<SeenPoint> seen(pixels);
  std::vector<std::int32_t> covered(pixels, -1);  // by which surface, the latest
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const std::int32_t index = static_cast<std::int32_t>(s);
    const int body = surfaces_[s].body;
    WholeExtent whole{0, pinhole_.width(), pinhole_.height(), 0, 0};
    visitFacets(s, [&](const auto& depthAt, std::int32_t triangle, const PictureBox& box) {
      visitCentres(box, [&](int x, int y) {
        const double depth = depthAt(pinhole_.rayAt(x + 0.5, y + 0.5));
        if (depth == kMiss) return;
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(pinhole_.width()) + static_cast<std::size_t>(x);
        if (depth < seen[pixel].depth) seen[pixel] = {depth, index, triangle};
        if (covered[pixel] == index) return;
        covered[pixel] = index;
        ++whole.pixels;
        whole.left = std::min(whole.left, x), whole.right = std::max(whole.right, x + 1);
        whole.top = std::min(whole.top, y), whole.bottom = std::max(whole.bottom, y + 1);
      });
    });
    if (body != kWorld && whole.pixels > 0) wholes[static_cast<std::size_t>(body)] = whole;
  }
  return seen;
}

void PictureRays::fillTiles() {
  const Eigen::Vector2f margin = Eigen::Vector2f::Constant(kFacetMargin);
  tiles_.resize(static_cast<std::size_t>(tilesAcross_) * static_cast<std::size_t>(tilesDown_));
  for (std::size_t s = 0; s < surfaces_.size(); ++s)
    visitFacets(s, [&](const auto&, std::int32_t triangle, const PictureBox& box) {
      const auto tile = [](double place, int count) {
        return std::clamp(static_cast<int>(place / kTile), 0, count - 1);
      };
      const int left = tile(box.min().x(), tilesAcross_), right = tile(box.max().x(), tilesAcross_);
      const int top = tile(box.min().y(), tilesDown_), bottom = tile(box.max().y(), tilesDown_);
      for (int y = top; y <= bottom; ++y)
        for (int x = left; x <= right; ++x)
          tiles_[static_cast<std::size_t>(y * tilesAcross_ + x)].push_back(
              {{box.min().cast<float>() - margin, box.max().cast<float>() + margin},
               static_cast<std::int32_t>(s),
               triangle});
    });
}

SeenPoint PictureRays::seenAt(double x, double y) {
  if (tiles_.empty()) fillTiles();
  const int across = std::clamp(static_cast<int>(x / kTile), 0, tilesAcross_ - 1);
  const int down = std::clamp(static_cast<int>(y / kTile), 0, tilesDown_ - 1);
  const Vec3 ray = pinhole_.rayAt(x, y);
  const Eigen::Vector2f place(static_cast<float>(x), static_cast<float>(y));
  SeenPoint seen;
  for (const Facet& facet : tiles_[static_cast<std::size_t>(down * tilesAcross_ + across)]) {
    if (!facet.box.contains(place)) continue;
    const std::size_t surface = static_cast<std::size_t>(facet.surface);
    const Prepared& prepared = prepared_[surface];
    const double depth = std::visit(
        Overloaded{
            [&](const auto& shape) { return depthAlong(prepared.origin, prepared.shapeFromCamera * ray, shape); },
            [&](const WorldTriangles& mesh) {
              const Triangle& triangle = (*mesh.triangles)[static_cast<std::size_t>(facet.triangle)];
              return SeenTriangle(cornersOf(triangle, prepared.vertices)).depthAlong(ray);
            }},
        surfaces_[surface].shape);
    if (depth < seen.depth) seen = {depth, facet.surface, facet.triangle};
  }
  return seen;
}

Vec3 PictureRays::pointAt(double x, double y, const SeenPoint& seen) const {
  return pinhole_.inWorld(seen.depth * pinhole_.rayAt(x, y));
}

Vec3 PictureRays::normalAt(double x, double y, const SeenPoint& seen) const {
  const std::size_t index = static_cast<std::size_t>(seen.surface);
  const Prepared& prepared = prepared_[index];
  const Vec3 ray = pinhole_.rayAt(x, y);
  const Vec3 normal =
      std::visit(Overloaded{[&](const auto& shape) -> Vec3 {
                              const Vec3 point = prepared.origin + seen.depth * (prepared.shapeFromCamera * ray);
                              return prepared.shapeFromCamera.transpose() * normalOf(shape, point);
                            },
                            [&](const WorldTriangles& mesh) -> Vec3 {
                              const Triangle& triangle = (*mesh.triangles)[static_cast<std::size_t>(seen.triangle)];
                              return SeenTriangle(cornersOf(triangle, prepared.vertices)).normal();
                            }},
                 surfaces_[index].shape);
  const double side = normal.dot(ray) > 0 ? -1 : 1;
  return pinhole_.worldFromCamera() * (side * normal.normalized());
}

}  // namespace cradle
