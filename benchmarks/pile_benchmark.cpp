// Spheres, boxes and turned boxes dropped into a tray, ours beside Bullet in one run: CPU time a step of 1/60 s, the
// deepest overlap (found from the poses alone, each step), and when all lie still. Usage: benchmark_pile BODIES
// spheres|boxes|turned SECONDS; benchmark_pile sizes: 5000 bodies beside 1000; benchmark_pile threads BODIES: two
// threads beside two runs at once; without arguments all of these, one after the other.

#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <thread>

#include "impact/pile_step.h"

namespace cradle {
namespace {

constexpr double kTimeStep = 1.0 / 60;  // s
constexpr double kHalf = 0.1;           // m: radius of the spheres, half the side of the cubes
constexpr double kFriction = 0.5;
constexpr int kFallingSteps = 90;

double secondsOf(clockid_t clock) {
  timespec time;
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// A jittered grid over a tray of five planes; all bodies have 1 kg.
struct Scene {
  bool areBoxes = false;
  double width = 2.4;  // m
  std::vector<Vec3> positions;
  std::vector<Quat> turns;
};

Scene makeScene(int bodies, const std::string& kind) {
  Scene scene;
  scene.areBoxes = kind != "spheres";
  scene.width = bodies <= 1000 ? 2.4 : 4.6;
  std::mt19937 random(1);
  const auto jitter = [&](double size) { return size * (static_cast<double>(random()) / 2147483648.0 - 1); };
  const double pitch = kind == "turned" ? 0.36 : 0.22;
  const int side = static_cast<int>((scene.width - 0.1) / pitch);
  for (int i = 0; i < bodies; ++i) {
    const int layer = i / (side * side), row = i / side % side, column = i % side;
    const double corner = -pitch * (side - 1) / 2;
    scene.positions.emplace_back(corner + pitch * column + jitter(0.005), 0.2 + 1.05 * pitch * layer,
                                 corner + pitch * row + jitter(0.005));
    scene.turns.push_back(Quat::Identity());
    if (kind == "turned") scene.turns.back() = Quat(jitter(1), jitter(1), jitter(1), jitter(1)).normalized();
  }
  return scene;
}

std::vector<PlaneCollider> planesOf(const Scene& scene) {
  std::vector<PlaneCollider> planes{{Vec3::Zero(), Vec3::UnitY(), 0}};
  for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)})
    planes.push_back({-scene.width / 2 * normal, normal, 0});
  return planes;
}

/// Depth of two cubes in each other: 15 axes.
double depthOfCubes(const Vec3& offset, const Mat3& a, const Mat3& b) {
  double least = 1e9;
  const auto consider = [&](const Vec3& axis) {
    const double length = axis.norm();
    if (length < 1e-6) return;
    const double reach = kHalf * ((a.transpose() * axis).cwiseAbs().sum() + (b.transpose() * axis).cwiseAbs().sum());
    least = std::min(least, (reach - std::abs(offset.dot(axis))) / length);
  };
  for (int i = 0; i < 3; ++i) {
    consider(a.col(i)), consider(b.col(i));
    for (int j = 0; j < 3; ++j) consider(a.col(i).cross(b.col(j)));
  }
  return least;
}

struct Poses {
  std::vector<Vec3> positions;
  std::vector<Mat3> turns;
  double fastest = 0;  // m/s
};

double deepestOverlap(const Scene& scene, const Poses& poses) {
  double most = 0;
  std::vector<std::size_t> order(poses.positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return poses.positions[a].x() < poses.positions[b].x(); });
  for (const PlaneCollider& plane : planesOf(scene))
    for (std::size_t i = 0; i < order.size(); ++i) {
      const double reach = scene.areBoxes ? (poses.turns[i].transpose() * plane.normal).cwiseAbs().sum() : 1;
      most = std::max(most, kHalf * reach - plane.normal.dot(poses.positions[i] - plane.point));
    }
  const double reach = 2 * kHalf * (scene.areBoxes ? std::sqrt(3.0) : 1);
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Vec3 offset = poses.positions[order[j]] - poses.positions[order[i]];
      if (offset.x() > reach) break;
      if (offset.squaredNorm() > reach * reach) continue;
      most = std::max(most, scene.areBoxes ? depthOfCubes(offset, poses.turns[order[i]], poses.turns[order[j]])
                                           : 2 * kHalf - offset.norm());
    }
  return most;
}

class OurWorld {
 public:
  OurWorld(const Scene& scene, int threads) : bodies_(bodiesOf(scene)), geometry_(geometryOf(scene)) {
    state_.setZero(stateSize(std::ssize(bodies_)));
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      centerOfMass(state_, static_cast<Eigen::Index>(i)) = scene.positions[i];
      setOrientation(state_, static_cast<Eigen::Index>(i), scene.turns[i]);
    }
    step_ = std::make_unique<PileStep>(bodies_, geometry_, Vec3(0, -9.81, 0), threads);
  }
  void advance() { step_->advance(kTimeStep, state_); }
  bool isAtRest() const { return step_->allAsleep(); }
  Poses poses() const {
    Poses poses;
    for (Eigen::Index i = 0; i < bodyCount(state_); ++i) {
      poses.positions.emplace_back(centerOfMass(state_, i));
      poses.turns.push_back(orientation(state_, i).toRotationMatrix());
      poses.fastest = std::max(poses.fastest, linearVelocity(state_, i).norm());
    }
    return poses;
  }

 private:
  static std::vector<RigidBody> bodiesOf(const Scene& scene) {
    const double inertia = scene.areBoxes ? 4 * kHalf * kHalf / 6 : 0.4 * kHalf * kHalf;
    return std::vector<RigidBody>(scene.positions.size(),
                                  makeRigidBody({1, Vec3::Zero(), Mat3(inertia * Mat3::Identity())}));
  }
  static ContactGeometry geometryOf(const Scene& scene) {
    ContactGeometry geometry;
    Collider collider = scene.areBoxes ? colliderOf(Box{Vec3::Constant(2 * kHalf)}, RigidTransform{})
                                       : colliderOf(Sphere{kHalf}, RigidTransform{});
    for (std::size_t i = 0; i < scene.positions.size(); ++i) {
      collider.body = static_cast<int>(i);
      geometry.colliders.push_back(collider);
    }
    geometry.planes = planesOf(scene);
    geometry.laws = {{{0, kFriction, kFriction}}};
    return geometry;
  }

  std::vector<RigidBody> bodies_;
  ContactGeometry geometry_;
  VectorX state_;
  std::unique_ptr<PileStep> step_;
};

/// With Bullet's defaults; friction of a pair is the product there.
class BulletWorld {
 public:
  explicit BulletWorld(const Scene& scene) {
    world_.setGravity(btVector3(0, -9.81, 0));
    if (scene.areBoxes)
      shapes_.push_back(std::make_unique<btBoxShape>(btVector3(kHalf, kHalf, kHalf)));
    else
      shapes_.push_back(std::make_unique<btSphereShape>(kHalf));
    btVector3 inertia;
    shapes_[0]->calculateLocalInertia(1, inertia);
    for (std::size_t i = 0; i < scene.positions.size(); ++i)
      add(1, shapes_[0].get(), inertia, scene.positions[i], scene.turns[i]);
    for (const PlaneCollider& plane : planesOf(scene)) {
      const Vec3& n = plane.normal;
      shapes_.push_back(std::make_unique<btStaticPlaneShape>(btVector3(n.x(), n.y(), n.z()), n.dot(plane.point)));
      add(0, shapes_.back().get(), btVector3(0, 0, 0), Vec3::Zero(), Quat::Identity());
    }
  }
  ~BulletWorld() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  void advance() { world_.stepSimulation(kTimeStep, 0); }
  bool isAtRest() const {
    return std::none_of(bodies_.begin(), bodies_.end(),
                        [](const auto& body) { return !body->isStaticObject() && body->isActive(); });
  }
  Poses poses() const {
    Poses poses;
    for (const auto& body : bodies_) {
      if (body->isStaticObject()) continue;
      const btVector3& at = body->getCenterOfMassPosition();
      const btQuaternion q = body->getOrientation();
      poses.positions.emplace_back(at.x(), at.y(), at.z());
      poses.turns.push_back(Quat(q.w(), q.x(), q.y(), q.z()).toRotationMatrix());
      poses.fastest = std::max(poses.fastest, static_cast<double>(body->getLinearVelocity().length()));
    }
    return poses;
  }

 private:
  void add(double mass, btCollisionShape* shape, const btVector3& inertia, const Vec3& at, const Quat& q) {
    bodies_.push_back(std::make_unique<btRigidBody>(static_cast<btScalar>(mass), nullptr, shape, inertia));
    const btTransform place(btQuaternion(q.x(), q.y(), q.z(), q.w()), btVector3(at.x(), at.y(), at.z()));
    bodies_.back()->setWorldTransform(place);
    bodies_.back()->setFriction(std::sqrt(kFriction));
    world_.addRigidBody(bodies_.back().get());
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadPhase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadPhase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

struct Figures {
  double falling = 0, settling = 0, all = 0;                 // ms a step: the first, those until all lie still, all
  double deepestFalling = 0, deepest = 0, deepestAtEnd = 0;  // mm: in the first steps, after them, at the end
  double restTime = -1;                                      // s; -1: never
};

template <class World>
Figures measure(const Scene& scene, World& world, int steps) {
  Figures figures;
  int settlingSteps = 0;
  for (int step = 0; step < steps; ++step) {
    const double before = secondsOf(CLOCK_PROCESS_CPUTIME_ID);
    world.advance();
    const double cost = 1e3 * (secondsOf(CLOCK_PROCESS_CPUTIME_ID) - before);
    figures.all += cost / steps;
    if (step < kFallingSteps)
      figures.falling += cost / kFallingSteps;
    else if (figures.restTime < 0)
      figures.settling += cost, ++settlingSteps;
    if (figures.restTime < 0 && world.isAtRest()) figures.restTime = (step + 1) * kTimeStep;
    figures.deepestAtEnd = 1e3 * deepestOverlap(scene, world.poses());
    double& deepest = step < kFallingSteps ? figures.deepestFalling : figures.deepest;
    deepest = std::max(deepest, figures.deepestAtEnd);
  }
  if (settlingSteps > 0) figures.settling /= settlingSteps;
  return figures;
}

void print(const std::string& who, const Figures& figures, const Figures& bullet) {
  fmt::print(
      "  {:<7} falling {:6.3f} ms ({:.2f} of Bullet's), then until rest {:6.3f} ms, all {:6.3f} ms ({:.2f} of "
      "Bullet's)\n"
      "          deepest falling {:5.1f} mm, later {:5.1f} mm, at the end {:4.1f} mm; rest at {:.2f} s\n",
      who, figures.falling, figures.falling / bullet.falling, figures.settling, figures.all, figures.all / bullet.all,
      figures.deepestFalling, figures.deepest, figures.deepestAtEnd, figures.restTime);
}

void compare(int bodies, const std::string& kind, int steps) {
  const Scene scene = makeScene(bodies, kind);
  OurWorld ours(scene, 1);
  BulletWorld bullet(scene);
  const Figures our = measure(scene, ours, steps), theirs = measure(scene, bullet, steps);
  fmt::print("{} {}, {} steps, one thread\n", bodies, kind, steps);
  print("cradle", our, theirs);
  print("Bullet", theirs, theirs);
}

double cpuOf(const Scene& scene, int steps) {
  OurWorld world(scene, 1);
  const double start = secondsOf(CLOCK_PROCESS_CPUTIME_ID);
  for (int step = 0; step < steps; ++step) world.advance();
  return secondsOf(CLOCK_PROCESS_CPUTIME_ID) - start;
}

void compareSizes() {
  constexpr int kSteps = 300;
  for (const std::string kind : {"spheres", "boxes", "turned"}) {
    const double few = cpuOf(makeScene(1000, kind), kSteps), many = cpuOf(makeScene(5000, kind), kSteps);
    fmt::print("{} steps of 5000 {}: {:.1f} times the CPU time of 1000\n", kSteps, kind, many / few);
  }
}

double wallOf(const Scene& scene, int threads, int steps) {
  OurWorld world(scene, threads);
  const double start = secondsOf(CLOCK_MONOTONIC);
  for (int step = 0; step < steps; ++step) world.advance();
  return secondsOf(CLOCK_MONOTONIC) - start;
}

void compareThreads(int bodies) {
  constexpr int kSteps = 120;
  for (const std::string kind : {"spheres", "boxes", "turned"}) {
    const Scene scene = makeScene(bodies, kind);
    const double one = wallOf(scene, 1, kSteps), two = wallOf(scene, 2, kSteps);
    const double start = secondsOf(CLOCK_MONOTONIC);
    std::thread other([&] { wallOf(scene, 1, kSteps); });
    wallOf(scene, 1, kSteps);
    other.join();
    const double both = secondsOf(CLOCK_MONOTONIC) - start;
    fmt::print("{} {}: two threads {:.2f} times as fast as one, two runs at once {:.2f} times; {:.2f} of it\n", bodies,
               kind, one / two, 2 * one / both, (one / two) / (2 * one / both));
  }
}

}  // namespace
}  // namespace cradle

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool all = arguments.empty();
  const auto isAsked = [&](const std::string& what) { return all || arguments[0] == what; };
  if (all || arguments.size() == 3) {
    fmt::print("Bullet {} with {} precision\n", btGetVersion(), sizeof(btScalar) == 8 ? "double" : "single");
    const int bodies = all ? 1000 : std::stoi(arguments[0]);
    const int steps = static_cast<int>(60 * (all ? 10 : std::stod(arguments[2])));
    for (const std::string kind : {"spheres", "boxes", "turned"})
      if (all || arguments[1] == kind) cradle::compare(bodies, kind, steps);
  }
  if (isAsked("sizes")) cradle::compareSizes();
  if (isAsked("threads")) cradle::compareThreads(arguments.size() > 1 ? std::stoi(arguments[1]) : 5000);
}
