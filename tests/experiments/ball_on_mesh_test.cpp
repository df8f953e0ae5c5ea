#include <gtest/gtest.h>

#include "experiments/ridged_ground.h"

// A ball that slides or rolls over a mesh: its contact passes from facet to edge to facet, at events.

namespace cradle {
namespace {

constexpr double kSlidingRadius = 0.1;  // m, of the ball
constexpr const char* kFrictionlessMesh = R"("restitution": 0, "staticFriction": 0, "dynamicFriction": 0)";

std::string slidingBall(const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  return fmt::format(R"({{"name": "b", "shape": {{"sphere": {{"radius": {}}}}}, "mass": 1, "material": "m",
    "position": {}, "linearVelocity": {}}})",
                     kSlidingRadius, vectorText(position), vectorText(velocity));
}

/// What a point mass may do inside of half-spaces n . x >= offset: it falls, slides along the planes without friction,
/// and loses what closes where it comes to another one.
class SlidingPoint {
 public:
  SlidingPoint(std::vector<std::pair<Vec3, double>> planes, const Vec3& position)
      : planes_(std::move(planes)), position(position) {}

  void advance(double time) {
    while (time > 0) {
      std::vector<Vec3> touching;
      for (const auto& [normal, offset] : planes_)
        if (normal.dot(position) - offset < kTouching) touching.push_back(normal);
      velocity = nearestInCone(touching, velocity);
      std::erase_if(touching, [&](const Vec3& normal) { return normal.dot(velocity) > kTouching; });
      const Vec3 acceleration = nearestInCone(touching, Vec3(0, -kGravity, 0));
      double first = time;
      for (const auto& [normal, offset] : planes_) {
        const double height = normal.dot(position) - offset, rate = normal.dot(velocity);
        const double bend = normal.dot(acceleration);
        if (height >= kTouching) first = std::min(first, timeToZero(height, rate, bend));
      }
      position += first * velocity + first * first / 2 * acceleration;
      velocity += first * acceleration;
      time -= first;
    }
  }

 private:
  static constexpr double kTouching = 1e-12;  // m, or m/s

  static double timeToZero(double height, double rate, double bend) {
    const double root = rate * rate - 2 * bend * height;
    if (root < 0 || (rate >= 0 && bend >= 0)) return INFINITY;
    const double time = 2 * height / (std::sqrt(root) - rate);
    return time > 0 ? time : INFINITY;
  }

  /// The vector nearest to a given one among those with n . v >= 0: given ones less some of their parts along normals.
  static Vec3 nearestInCone(const std::vector<Vec3>& normals, const Vec3& wanted) {
    Vec3 best = Vec3::Zero();
    const auto keep = [&](const Vec3& found) {
      const bool isIn = std::all_of(normals.begin(), normals.end(),
                                    [&](const Vec3& normal) { return normal.dot(found) >= -kTouching; });
      if (isIn && (found - wanted).norm() < (best - wanted).norm()) best = found;
    };
    keep(wanted);
    for (const Vec3& one : normals) {
      keep(wanted - one.dot(wanted) * one);
      for (const Vec3& other : normals) {
        const Vec3 along = one.cross(other);
        if (along.norm() > kTouching) keep(along * along.dot(wanted) / along.squaredNorm());
      }
    }
    return best;
  }

  std::vector<std::pair<Vec3, double>> planes_;

 public:
  Vec3 position, velocity = Vec3::Zero();
};

/// Where the centre of a ball may be inside of a bowl that is convex from within.
std::vector<std::pair<Vec3, double>> planesInside(const LoadedModel& bowl) {
  std::vector<std::pair<Vec3, double>> planes;
  const TriangleMesh& mesh = bowl.model.solid;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3& corner = mesh.vertices[a];
    const Vec3 normal = (mesh.vertices[b] - corner).cross(mesh.vertices[c] - corner).normalized();
    const bool isOfInside = corner.norm() < 1.05 && normal.dot(corner) < 0 && mesh.vertices[b].norm() < 1.05 &&
                            mesh.vertices[c].norm() < 1.05;
    const auto isSame = [&](const auto& plane) { return (plane.first - normal).norm() < 1e-9; };
    if (isOfInside && std::none_of(planes.begin(), planes.end(), isSame))
      planes.emplace_back(normal, normal.dot(corner) + kSlidingRadius);
  }
  return planes;
}

// The ball's centre is a point mass inside of planes moved inwards by the radius. Errors of a step are 0.1 of the
// accuracy; a crease turns the motion by up to 45 degrees, and the ball passes some twenty: a factor of 1000 is ample.
TEST(BallInAFacetedBowl, SlidesAsAPointOnTheFacetsMovedInwards) {
  for (const auto& [sides, bands] : {std::pair(5, 2), std::pair(8, 3), std::pair(16, 8)})
    for (const double accuracy : {1e-4, 1e-6, 1e-9}) {
      const LoadedModel bowl = facetedBowl(sides, bands, false);
      const Vec3 start(0.3, -0.6, 0.1);
      const Trajectory run = runOverMesh(bowl, accuracy, 1.5, kFrictionlessMesh, slidingBall(start));
      SlidingPoint point(planesInside(bowl), start);
      double energy = INFINITY;
      for (const Frame& frame : run.frames) {
        if (frame.time > 0) point.advance(1.0 / 240);
        ASSERT_LT((frame.states[0].position - point.position).norm(), 1000 * accuracy)
            << sides << " sides, " << accuracy << ", " << frame.time;
        for (const auto& [normal, offset] : planesInside(bowl))
          ASSERT_GT(normal.dot(frame.states[0].position), offset - 10 * accuracy * kSlidingRadius) << frame.time;
        EXPECT_LT(mechanicalEnergy(frame), energy + 10 * accuracy) << frame.time;
        energy = mechanicalEnergy(frame);
      }
      EXPECT_GT(eventsOf(run, EventKind::impact).size(), 3u);
    }
}

// From a level top to a slope, and from there to a level floor. On the edge the centre goes along an arc: slow enough,
// as gravity bends the way as much; 0.3^2 + 2 g R (1 - cos) is below g R cos.
TEST(BallOverAnEdge, RollsAroundItAndKeepsItsEnergy) {
  // (A solid without hollows is a hull.)
  const Profile profile = {{-3, 0.3}, {-2.5, 0}, {0, 0}, {1.5, -0.3}, {6, -1.2}};
  for (const bool isSheet : {false, true})
    for (const double friction : {0.0, 0.6})
      for (const double accuracy : {1e-4, 1e-6, 1e-9}) {
        std::string ball = slidingBall(Vec3(-0.2, kSlidingRadius, 0), Vec3(0.3, 0, 0));
        if (friction > 0)
          ball.insert(ball.size() - 1, fmt::format(R"(, "angularVelocity": [0, 0, {}])", -0.3 / kSlidingRadius));
        const Trajectory run = runOverMesh(
            ridgedGround(profile, isSheet), accuracy, 1.6,
            fmt::format(R"("restitution": 0, "staticFriction": {}, "dynamicFriction": {})", friction, friction), ball);
        const double energy = mechanicalEnergy(run.frames[0]);
        for (const Frame& frame : run.frames) {
          ASSERT_NEAR(distanceFrom(profile, frame.states[0].position), kSlidingRadius, 10 * accuracy) << frame.time;
          ASSERT_NEAR(mechanicalEnergy(frame), energy, 10 * accuracy * kGravity) << frame.time;
        }
        EXPECT_GT(endOf(run).position.x(), 0.4);
        // The border between an edge and a face is 4e-9 of the mesh's size wide: the normal turns by 4e-7 rad there,
        // and at 0.4 m/s the ball may leave it or come down on it by as much.
        for (const Event& impact : eventsOf(run, EventKind::impact)) EXPECT_LT(impact.impulse, 1e-6);
      }
}

// Faster than sqrt(g R) it flies: a parabola from the edge on.
TEST(BallOverAnEdge, FliesWhereGravityBendsTheWayLess) {
  const double speed = 2;
  for (const bool isSheet : {false, true}) {
    const Trajectory run = runOverMesh(ridgedGround({{-3, 0}, {0, 0}, {6, -4}}, isSheet), 1e-8, 0.3, kFrictionlessMesh,
                                       slidingBall(Vec3(-0.2, kSlidingRadius, 0), Vec3(speed, 0, 0)));
    for (const Frame& frame : run.frames) {
      const double x = -0.2 + speed * frame.time, fall = std::max(0.0, x) / speed;
      ASSERT_NEAR(frame.states[0].position.x(), x, 1e-7) << frame.time;
      ASSERT_NEAR(frame.states[0].position.y(), kSlidingRadius - kGravity / 2 * fall * fall, 1e-7) << frame.time;
    }
  }
}

// Grooves, steps, waves and walls much narrower than the way that a step could go.
TEST(BallOverNarrowCreases, NeverComesNearerThanItsRadius) {
  Profile waves = {{-3, 0}};
  for (int i = 0; i <= 40; ++i) waves.emplace_back(0.05 * i, i % 2 == 0 ? 0 : 0.002);
  waves.emplace_back(6, 0);
  const std::vector<Profile> profiles = {
      {{-3, 0}, {0, 0}, {0.001, -0.1}, {0.002, 0}, {6, 0}},
      {{-3, 0}, {0, 0}, {0.001, 0.0005}, {0.002, 0}, {6, 0}},
      {{-3, 0}, {0, 0}, {0.5, 0.02}, {0.501, -0.04}, {2, -0.04}, {2.2, 0.5}, {6, 0.5}},
      waves};
  for (const Profile& profile : profiles)
    for (const bool isSheet : {false, true})
      for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
        const Trajectory run = runOverMesh(ridgedGround(profile, isSheet), accuracy, 2, kFrictionlessMesh,
                                           slidingBall(Vec3(-0.5, kSlidingRadius, 0), Vec3(1, 0, 0.2)));
        double energy = INFINITY;
        for (const Frame& frame : run.frames) {
          const BodyState& ball = frame.states[0];
          ASSERT_GT(distanceFrom(profile, ball.position), kSlidingRadius - 10 * accuracy * kSlidingRadius)
              << profile.size() << " at " << frame.time;
          ASSERT_GT(ball.position.y(), -0.04) << frame.time;
          ASSERT_LT(mechanicalEnergy(frame), energy + 10 * accuracy) << frame.time;
          energy = mechanicalEnergy(frame);
        }
      }
}

}  // namespace
}  // namespace cradle
