#include "pile_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

namespace cradle {
namespace {

constexpr double kHalf = 0.1;      // m: radius of the spheres, half the side of the cubes
constexpr double kDensity = 1000;  // kg/m^3, where bodies differ
constexpr double kPi = 3.14159265358979324;
constexpr double kMinAxis = 1e-6;  // of a unit: edges that are parallel have no axis of their own
constexpr int kSearchSteps = 60;   // of a golden section: 0.618^60 = 3e-13

/// The hull of points about their centre of mass.
std::shared_ptr<const PileHull> pileHullOf(const std::vector<Vec3>& points) {
  auto made = std::make_shared<PileHull>();
  made->hull = convexHullOf(points);
  const Vec3 center = computeMassProperties(trianglesOf(made->hull), kDensity).centerOfMass;
  std::vector<Vec3>& corners = made->hull.vertices;
  for (Vec3& corner : corners) corner -= center;
  made->massProperties = computeMassProperties(trianglesOf(made->hull), kDensity);
  for (const std::vector<std::size_t>& loop : made->hull.faces) {
    made->faceNormals.push_back(
        (corners[loop[1]] - corners[loop[0]]).cross(corners[loop[2]] - corners[loop[0]]).normalized());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::size_t from = loop[i], to = loop[(i + 1) % loop.size()];
      if (from < to) made->edges.push_back((corners[to] - corners[from]).normalized());
    }
  }
  return made;
}

/// Points spread over an ellipsoid, which are all corners of their hull.
std::vector<Vec3> pointsOnEllipsoid(std::mt19937& random) {
  const auto between = [&](double least, double most) {
    return least + (most - least) * static_cast<double>(random()) / 4294967295.0;
  };
  const double x = between(0.07, 0.13), y = between(0.07, 0.13), z = between(0.07, 0.13);
  std::vector<Vec3> points(12 + random() % 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double height = (2 * (static_cast<double>(i) + 0.5) / static_cast<double>(points.size())) - 1;
    const double angle = kPi * (3 - std::sqrt(5.0)) * static_cast<double>(i) + between(-0.3, 0.3);
    const double around = std::sqrt(1 - height * height);
    points[i] = Vec3(x * around * std::cos(angle), y * height, z * around * std::sin(angle));
  }
  return points;
}

PileItem itemOf(const std::string& kind, std::mt19937& random) {
  const auto between = [&](double least, double most) {
    return least + (most - least) * static_cast<double>(random()) / 4294967295.0;
  };
  PileItem item;
  if (kind == "spheres") item.radius = kHalf;
  if (kind == "boxes" || kind == "turned") item.halfSize = Vec3::Constant(kHalf);
  if (kind == "bars") item.halfSize = Vec3(0.04, 0.3, 0.05);
  if (kind == "hulls") {
    item.hull = pileHullOf(pointsOnEllipsoid(random));
    item.mass = item.hull->massProperties.mass;
    for (const Vec3& corner : item.hull->hull.vertices) item.halfSize = item.halfSize.cwiseMax(corner.cwiseAbs());
  }
  if (kind == "capsules") item.radius = 0.06, item.halfSize = Vec3(0, between(0.05, 0.2), 0);
  if (kind == "mixed") {
    const bool isSphere = random() % 2 == 0;
    const double x = between(0.04, 0.15), y = between(0.04, 0.15), z = between(0.04, 0.15);
    if (isSphere)
      item.radius = x;
    else
      item.halfSize = Vec3(x, y, z);
  }
  if (kind == "bars" || kind == "capsules" || kind == "mixed") {
    const double r = item.radius, length = 2 * item.halfSize.y();
    item.mass = kDensity * (item.isBox() ? 8 * item.halfSize.prod() : kPi * r * r * (length + 4 * r / 3));
  }
  return item;
}

/// Depth of two boxes in each other: 15 axes (S. Gottschalk, M. Lin, D. Manocha, "OBBTree", SIGGRAPH 1996).
double depthOfBoxes(const PileItem& first, const PileItem& second, const Vec3& offset, const Mat3& a, const Mat3& b) {
  double least = 1e9;
  const auto consider = [&](const Vec3& axis) {
    const double length = axis.norm();
    if (length < kMinAxis) return;
    const double reach =
        (a.transpose() * axis).cwiseAbs().dot(first.halfSize) + (b.transpose() * axis).cwiseAbs().dot(second.halfSize);
    least = std::min(least, (reach - std::abs(offset.dot(axis))) / length);
  };
  for (int i = 0; i < 3; ++i) {
    consider(a.col(i)), consider(b.col(i));
    for (int j = 0; j < 3; ++j) consider(a.col(i).cross(b.col(j)));
  }
  return least;
}

double distanceToBox(const Vec3& halfSize, const Vec3& point) {
  const Vec3 beyond = point.cwiseAbs() - halfSize;
  return beyond.cwiseMax(0).norm() + std::min(0.0, beyond.maxCoeff());
}

/// Least value of a convex function on [-1, 1].
template <class Function>
double leastOf(const Function& function) {
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  double from = -1, to = 1;
  for (int i = 0; i < kSearchSteps; ++i) {
    const double low = to - ratio * (to - from), high = from + ratio * (to - from);
    if (function(low) < function(high))
      to = high;
    else
      from = low;
  }
  return function((from + to) / 2);
}

/// Depth of a round body in a box or another round one: distance is convex along both segments.
double depthOfRound(const PileItem& round, const PileItem& other, const Vec3& offset, const Mat3& a, const Mat3& b) {
  const Vec3 alongA = a.col(1) * round.halfSize.y(), alongB = b.col(1) * other.halfSize.y();
  const auto fromA = [&](double s) {
    const Vec3 point = s * alongA - offset;
    if (other.isBox()) return distanceToBox(other.halfSize, b.transpose() * point);
    const double length2 = alongB.squaredNorm();
    const double t = length2 > 0 ? std::clamp(point.dot(alongB) / length2, -1.0, 1.0) : 0;
    return (point - t * alongB).norm() - other.radius;
  };
  return round.radius - (round.halfSize.isZero() ? fromA(0) : leastOf(fromA));
}

/// Depth of two hulls in each other, by the normals of all faces and the directions across all pairs of edges; without
/// these if the faces alone show that it is at most `enough` (m).
double depthOfHulls(const PileHull& first, const PileHull& second, const Vec3& offset, const Mat3& a, const Mat3& b,
                    double enough) {
  double least = 1e9;
  const auto reach = [](const PileHull& hull, const Vec3& direction) {
    double most = -1e9;
    for (const Vec3& corner : hull.hull.vertices) most = std::max(most, direction.dot(corner));
    return most;
  };
  const auto consider = [&](const Vec3& axis) {  // unit, from the first to the second
    const double apart = axis.dot(offset);
    least = std::min(least, reach(first, a.transpose() * axis) + reach(second, b.transpose() * -axis) - apart);
  };
  for (const Vec3& normal : first.faceNormals) consider(a * normal);
  for (const Vec3& normal : second.faceNormals) consider(-(b * normal));
  for (const Vec3& edgeA : first.edges) {
    if (least <= enough) return least;
    for (const Vec3& edgeB : second.edges) {
      const Vec3 axis = (a * edgeA).cross(b * edgeB);
      if (axis.norm() < kMinAxis) continue;
      consider(axis.normalized()), consider(-axis.normalized());
    }
  }
  return least;
}

double depthOf(const PileItem& first, const PileItem& second, const Vec3& offset, const Mat3& a, const Mat3& b,
               double enough) {
  if (first.hull) return depthOfHulls(*first.hull, *second.hull, offset, a, b, enough);
  if (!first.isBox()) return depthOfRound(first, second, offset, a, b);
  if (!second.isBox()) return depthOfRound(second, first, -offset, b, a);
  return depthOfBoxes(first, second, offset, a, b);
}

PileItem boxAt(const Vec3& halfSize, double mass, const Vec3& position) {
  PileItem item;
  item.halfSize = halfSize, item.mass = mass, item.position = position;
  return item;
}

/// Bricks of 0.4 x 0.2 x 0.2 m in rows of ten, every other row half a brick aside, and the ball before their middle.
void addWall(int bricks, PileScene& scene) {
  constexpr double kBallRadius = 0.4, kBallMass = 263, kBallSpeed = 8;  // m, kg, m/s
  const Vec3 half(0.2, 0.1, 0.1);
  for (int i = 0; i < bricks; ++i) {
    const int row = i / 10;
    const Vec3 position(0.4 * (i % 10) - 1.8 + 0.2 * (row % 2), 0.1 + 0.2 * row, 0);
    scene.items.push_back(boxAt(half, kDensity * 8 * half.prod(), position));
  }
  PileItem ball;
  ball.radius = kBallRadius, ball.mass = kBallMass;
  ball.position = Vec3(0, 0.2 * (bricks / 10) / 2, 2), ball.velocity = Vec3(0, 0, -kBallSpeed);
  scene.items.push_back(ball);
}

void addPyramid(int lowest, PileScene& scene) {
  for (int row = 0; row < lowest; ++row)
    for (int i = 0; i < lowest - row; ++i) {
      const Vec3 position(0.2 * i + 0.1 * row - 0.1 * (lowest - 1), kHalf + 0.2 * row, 0);
      scene.items.push_back(boxAt(Vec3::Constant(kHalf), 1, position));
    }
}

}  // namespace

const std::vector<std::string>& pileKinds() {
  static const std::vector<std::string> kinds{"spheres",  "boxes", "turned", "bars",   "mixed",
                                              "capsules", "hulls", "wall",   "pyramid"};
  return kinds;
}

PileScene makePileScene(int bodies, const std::string& kind, unsigned start) {
  if (std::count(pileKinds().begin(), pileKinds().end(), kind) == 0) throw std::invalid_argument("no heap of " + kind);
  PileScene scene;
  if (kind == "wall" || kind == "pyramid") {
    kind == "wall" ? addWall(bodies, scene) : addPyramid(bodies, scene);
    scene.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}};
    return scene;
  }
  std::mt19937 random(start), sizes(start + 1);
  const auto jitter = [&](double size) { return size * (static_cast<double>(random()) / 2147483648.0 - 1); };
  const bool isTurned = kind != "spheres" && kind != "boxes";
  const double pitch = !isTurned ? 0.22 : kind == "bars" ? 0.64 : kind == "mixed" || kind == "capsules" ? 0.55 : 0.36;
  const double ofCubes = bodies <= 1000 ? 2.4 : 4.6 * std::sqrt(std::max(1.0, bodies / 5000.0)),
               ofLongOnes = (bodies <= 1000 ? 7 : 12) * pitch + 0.1;
  scene.width = pitch > 0.5 ? ofLongOnes : ofCubes;
  const double lowest = std::max(0.2, pitch / 2 + 0.02);
  const int side = static_cast<int>((scene.width - 0.1) / pitch);
  for (int i = 0; i < bodies; ++i) {
    const int layer = i / (side * side), row = i / side % side, column = i % side;
    const double corner = -pitch * (side - 1) / 2;
    PileItem item = itemOf(kind, sizes);
    const double z = jitter(0.005), x = jitter(0.005);
    item.position = Vec3(corner + pitch * column + x, lowest + 1.05 * pitch * layer, corner + pitch * row + z);
    if (isTurned) {
      const double turn[] = {jitter(1), jitter(1), jitter(1), jitter(1)};
      item.turn = Quat(turn[3], turn[2], turn[1], turn[0]).normalized();
    }
    scene.items.push_back(item);
  }
  scene.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}};
  for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)})
    scene.planes.push_back({-scene.width / 2 * normal, normal, 0});
  return scene;
}

double deepestOverlap(const PileScene& scene, const PilePoses& poses) {
  double most = 0, farthest = 0;
  std::vector<std::size_t> order(poses.positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return poses.positions[a].x() < poses.positions[b].x(); });
  for (const std::size_t i : order) {
    const PileItem& item = scene.items[i];
    farthest = std::max(farthest, item.reach());
    for (const PlaneCollider& plane : scene.planes) {
      const Vec3 down = poses.turns[i].transpose() * -plane.normal;
      double reach = item.radius + down.cwiseAbs().dot(item.halfSize);
      if (item.hull) {
        reach = 0;
        for (const Vec3& corner : item.hull->hull.vertices) reach = std::max(reach, down.dot(corner));
      }
      most = std::max(most, reach - plane.normal.dot(poses.positions[i] - plane.point));
    }
  }
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const std::size_t a = order[i], b = order[j];
      const Vec3 offset = poses.positions[b] - poses.positions[a];
      const double reach = scene.items[a].reach() + scene.items[b].reach();
      if (offset.x() > scene.items[a].reach() + farthest) break;
      if (offset.squaredNorm() > reach * reach) continue;
      most = std::max(most, depthOf(scene.items[a], scene.items[b], offset, poses.turns[a], poses.turns[b], most));
    }
  return most;
}

}  // namespace cradle
