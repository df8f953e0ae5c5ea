// Patterns are painted in a body's frame: they turn with it, whatever its shape is drawn as.

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"
#include "render/camera.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

constexpr int kPictureWidth = 320, kPictureHeight = 240;

/// Red, painted with blue; of a body whose largest extent is 0.6 m, so that cells are 0.1 m wide.
Scene paintedScene(const Shape& shape, Pattern pattern, const Quat& turn) {
  Scene scene = emptyScene();
  scene.materials[0].baseColor = Vec3f(1, 0, 0);
  scene.materials[0].pattern = pattern;
  scene.materials[0].patternColor = Vec3f(0, 0, 1);
  addBody(scene, shape, {turn, Vec3(0.2, 0.1, 0)});
  scene.camera = cameraAt({0.2, 0.4, 2}, {0.2, 0.1, 0}, 0.5);
  return scene;
}

/// What is painted blue, of a point of the body's frame, by the rules of the documentation.
bool isBlue(Pattern pattern, const Vec3& point) {
  const Vec3 cell = (point / 0.1).array().floor();
  const auto isOdd = [](double number) { return std::fmod(std::abs(number), 2) == 1; };
  if (pattern == Pattern::stripes) return isOdd(cell.x());
  if (pattern == Pattern::checks) return isOdd(cell.sum());
  return std::sin(3 * std::atan2(point.z(), point.x())) > 0 || std::hypot(point.x(), point.z()) < 0.05;
}

/// Whether it is so clear of all borders (m) that a pixel shows one colour there.
bool isInside(Pattern pattern, const Vec3& point) {
  constexpr double kClear = 0.02;
  if (pattern == Pattern::beachBall) {
    const double across = std::hypot(point.x(), point.z());
    return std::abs(across - 0.05) > kClear &&
           std::abs(std::sin(3 * std::atan2(point.z(), point.x()))) * across / 3 > kClear;
  }
  const Vec3 share = point / 0.1 - Vec3((point / 0.1).array().round());
  const double least = pattern == Pattern::stripes ? std::abs(share.x()) : share.cwiseAbs().minCoeff();
  return 0.1 * least > kClear;
}

struct SurfacePoint {
  Vec3 place, normal;  // body's frame
};

std::vector<SurfacePoint> pointsOf(const Shape& shape) {
  std::vector<SurfacePoint> points;
  for (double u = 0.03; u < 1; u += 0.06)
    for (double v = 0.03; v < 1; v += 0.06) {
      const double angle = 2 * M_PI * u, height = 2 * v - 1, across = std::sqrt(1 - height * height);
      const Vec3 radial(std::cos(angle), 0, std::sin(angle));
      if (const auto* sphere = std::get_if<Sphere>(&shape)) {
        const Vec3 normal = across * radial + height * Vec3::UnitY();
        points.push_back({sphere->radius * normal, normal});
      }
      if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
        points.push_back({cylinder->radius * radial + cylinder->length / 2 * height * Vec3::UnitY(), radial});
        points.push_back({v * cylinder->radius * radial + cylinder->length / 2 * Vec3::UnitY(), Vec3::UnitY()});
      }
      if (const auto* box = std::get_if<Box>(&shape))
        for (int axis = 0; axis < 3; ++axis) {
          Vec3 place;
          place[axis] = 0.5 * box->size[axis];
          place[(axis + 1) % 3] = (u - 0.5) * box->size[(axis + 1) % 3];
          place[(axis + 2) % 3] = (v - 0.5) * box->size[(axis + 2) % 3];
          points.push_back({place, Vec3::Unit(axis)});
        }
      if (const auto* capsule = std::get_if<Capsule>(&shape))
        points.push_back({capsule->radius * radial + capsule->length / 2 * height * Vec3::UnitY(), radial});
    }
  return points;
}

TEST(Pattern, IsPaintedInTheFrameOfItsBody) {
  const std::vector<Shape> shapes = {Sphere{0.3}, Box{Vec3(0.6, 0.4, 0.5)}, Cylinder{0.2, 0.6}, Capsule{0.15, 0.3}};
  const std::vector<Quat> turns = {Quat::Identity(), rotationAbout(Vec3(1, 2, 3).normalized(), 1.1),
                                   rotationAbout(Vec3(-1, 0.5, 0.2).normalized(), 2.5)};
  long count = 0;
  for (const Shape& shape : shapes)
    for (const Pattern pattern : {Pattern::stripes, Pattern::checks, Pattern::beachBall})
      for (const Quat& turn : turns) {
        const Scene scene = paintedScene(shape, pattern, turn);
        const Image image = drawStart(scene, kPictureWidth, kPictureHeight);
        const RigidTransform& place = scene.bodies[0].worldFromBody;
        for (const SurfacePoint& point : pointsOf(shape)) {
          const Vec3 seen = place * point.place, towards = (scene.camera->position - seen).normalized();
          if (towards.dot(turn * point.normal) < 0.4 || !isInside(pattern, point.place)) continue;
          const Eigen::Vector2d pixel = projectToPixel(*scene.camera, seen, kPictureWidth, kPictureHeight);
          const auto* color = image.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
          EXPECT_EQ(color[2] > color[0], isBlue(pattern, point.place))
              << shape.index() << " " << static_cast<int>(pattern) << " at " << point.place.transpose();
          ++count;
        }
      }
  EXPECT_GT(count, 1000);
}

}  // namespace
}  // namespace cradle
