// A pile in a tray: ours beside Bullet.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <random>

#include "collision/polytope_contact.h"
#include "dynamics/invariants.h"
#include "impact/pile_step.h"

namespace cradle {
namespace {

double cpu() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct World {
  std::vector<RigidBody> bodies;
  ContactGeometry geometry;
  VectorX state;
};

World makeWorld(int n, const std::string& kind, double width) {
  World world;
  const bool boxes = kind != "spheres";
  world.state.setZero(stateSize(n));
  std::mt19937 random(1);
  const auto jitter = [&](double size) { return size * (static_cast<double>(random()) / 4294967295.0 * 2 - 1); };
  const double pitch = kind == "turned" ? 0.36 : 0.22;
  const int side = static_cast<int>((width - 0.1) / pitch);
  for (int i = 0; i < n; ++i) {
    const int layer = i / (side * side), row = i / side % side, column = i % side;
    const double start = -pitch * (side - 1) / 2;
    centerOfMass(world.state, i) = Vec3(start + pitch * column + jitter(0.005), 0.15 + pitch * layer * 1.05 + (boxes ? .05:0),
                                        start + pitch * row + jitter(0.005));
    Quat turn = Quat::Identity();
    if (kind == "turned") turn = Quat(jitter(1), jitter(1), jitter(1), jitter(1)).normalized();
    setOrientation(world.state, i, turn);
    RigidBody body;
    body.mass = body.inverseMass = 1;
    const double inertia = boxes ? 0.04 / 6 : 0.4 * 0.01;
    body.inertiaTensor = inertia * Mat3::Identity(), body.inverseInertia = 1 / inertia * Mat3::Identity();
    world.bodies.push_back(body);
    Collider collider;
    collider.body = i;
    if (boxes) {
      collider.polytope = polytopeOf(Box{Vec3::Constant(0.2)}, RigidTransform{});
      collider.points = collider.polytope->vertices;
      collider.boundingRadius = 0.1 * std::sqrt(3.0);
    } else {
      collider.points = {Vec3::Zero()};
      collider.radius = collider.boundingRadius = 0.1;
    }
    for (const Vec3& p : collider.points) collider.bounds.extend(Vec3(p - Vec3::Constant(collider.radius))), collider.bounds.extend(Vec3(p + Vec3::Constant(collider.radius)));
    world.geometry.colliders.push_back(collider);
  }
  world.geometry.laws = {{{0, 0.5, 0.5}}};
  world.geometry.planes.push_back({Vec3::Zero(), Vec3::UnitY()});
  for (const Vec3& n3 : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)})
    world.geometry.planes.push_back({-width / 2 * n3, n3});
  return world;
}

double deepest(const World& world) {
  double most = 0;
  const long n = static_cast<long>(world.bodies.size());
  const auto& state = world.state;
  std::vector<std::pair<double, long>> order;
  for (long i = 0; i < n; ++i) order.emplace_back(centerOfMass(state, i).x(), i);
  std::sort(order.begin(), order.end());
  for (long i = 0; i < n; ++i) {
    const auto& c = world.geometry.colliders[static_cast<size_t>(i)];
    for (const auto& plane : world.geometry.planes)
      for (const Vec3& p : c.points)
        most = std::max(most, c.radius - plane.normal.dot(poseOf(state, (int)i) * p - plane.point));
  }
  for (long s = 0; s < n; ++s)
    for (long u = s + 1; u < n && order[(size_t)u].first < order[(size_t)s].first + 0.36; ++u) {
      const int i = (int)order[(size_t)s].second, j = (int)order[(size_t)u].second;
      const auto &a = world.geometry.colliders[(size_t)i], &b = world.geometry.colliders[(size_t)j];
      const double d = (centerOfMass(state, i) - centerOfMass(state, j)).norm();
      if (d > a.boundingRadius + b.boundingRadius) continue;
      most = std::max(most, a.polytope ? -separationOf(*a.polytope, *b.polytope, poseOf(state, i), poseOf(state, j))
                                       : 0.2 - d);
    }
  return most;
}

double energyOf(const World& world) {
  Mechanism mechanism;
  mechanism.bodies = world.bodies, mechanism.gravity = Vec3(0, -9.81, 0);
  return energyConstant(mechanism, world.state);
}

void runWorld(int n, const std::string& kind, double width, int threads, bool measure) {
  World world = makeWorld(n, kind, width);
  PileStep step(world.bodies, world.geometry, Vec3(0, -9.81, 0), threads);
  double lastE = 0, firstE = 0;
  double sum = 0, fall = 0, late = 0, pen = 0, latePen = 0;
  const auto wall = std::chrono::steady_clock::now();
  for (int k = 0; k < 600; ++k) {
    const double before = cpu();
    static const int pieces = getenv("PC") ? atoi(getenv("PC")) : 1;
    for (int piece = 0; piece < pieces; ++piece) step.advance(1.0 / 60 / pieces, world.state);
    const double t = cpu() - before;
    sum += t;
    if (k < 180) fall += t;
    if (k >= 420) late += t;
    const double energy = energyOf(world);
    static double grew, most;
    if (k == 0) grew = most = 0;
    if (k && energy > lastE) grew += energy - lastE, most = std::max(most, energy - lastE);
    lastE = energy;
    if (k == 599) fmt::print("energy grew by {:.3e} in all, {:.3e} at most, of {:.3e}\n", grew, most, firstE);
    if (k == 0) firstE = energy;
    if (measure) {
      const double d = deepest(world);
      pen = std::max(pen, d);
      if (k >= 480) latePen = std::max(latePen, d);
      if (k % 60 == 59) {
        double v = 0, w = 0, low = 1e9;
        for (long i = 0; i < n; ++i) v = std::max(v, linearVelocity(world.state, i).norm()), w = std::max(w, angularVelocity(world.state, i).norm()), low=std::min(low, centerOfMass(world.state,i).y());
        fmt::print("  {} s: deepest now {:.2f} mm, most {:.2f} mm, v {:.4f} w {:.4f} active {} pairs {} E {:.3f}\n", (k + 1) / 60, 1e3 * d, 1e3 * pen, v, w, step.contacts().active().size(), step.geometry().pairs.size(), energyOf(world));
      }
    }
  }
  const double w = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  fmt::print("{} {} threads {}: falling {:.3f} ms, all {:.3f} ms, late {:.3f} ms, wall {:.3f} ms; deepest {:.2f} mm, at the end {:.2f} mm\n", n, kind, threads,
             1e3 * fall / 180, 1e3 * sum / 600, 1e3 * late / 180, 1e3 * w / 600, 1e3 * pen, 1e3 * latePen);
}

}  // namespace
}  // namespace cradle

int main(int argc, char** argv) {
  using namespace cradle;
  const int n = argc > 1 ? std::atoi(argv[1]) : 1000;
  const int threads = argc > 3 ? std::atoi(argv[3]) : 1;
  const bool measure = argc > 4;
  const double width = n <= 1000 ? 2.4 : 4.6;
  for (const std::string kind : {"spheres", "boxes", "turned"})
    if (argc < 3 || kind == argv[2] || std::string(argv[2]) == "all") runWorld(n, kind, width, threads, measure);
}
