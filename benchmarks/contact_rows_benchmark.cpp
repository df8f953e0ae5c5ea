// An evaluation of the equations of motion with lasting contacts, beside the same bodies without.

#include <benchmark/benchmark.h>

#include "constraints/equations_of_motion.h"
#include "math/rotation.h"

namespace cradle {
namespace {

RigidBody bodyOf(const Vec3& moments) {
  return makeRigidBody({1, Vec3::Zero(), moments.asDiagonal()});
}

Mechanism bodies(std::size_t count, const Vec3& moments) {
  Mechanism mechanism;
  mechanism.gravity = Vec3(0, -9.81, 0);
  mechanism.bodies.assign(count, bodyOf(moments));
  return mechanism;
}

/// Balls of radius 0.1 m on level ground.
Mechanism balls(std::size_t count, ContactMotion motion) {
  Mechanism mechanism = bodies(count, Vec3::Constant(0.004));
  for (std::size_t i = 0; i < count; ++i) {
    ContactConstraint contact;
    contact.centerA.body = static_cast<int>(i);
    contact.radiusA = 0.1;
    contact.motion = motion;
    contact.friction = 0.3;
    contact.slidingDirection = Vec3::UnitX();
    mechanism.contacts.push_back(contact);
  }
  return mechanism;
}

Mechanism box(int corners, ContactMotion motion) {
  Mechanism mechanism = bodies(1, Vec3(0.01, 0.02, 0.03));
  for (int i = 0; i < corners; ++i) {
    ContactConstraint contact;
    contact.centerA = {0, Vec3(i % 2 == 0 ? 0.2 : -0.2, -0.1, i < 2 ? 0.3 : -0.3)};
    contact.motion = motion;
    contact.friction = 0.3;
    contact.slidingDirection = Vec3::UnitX();
    mechanism.contacts.push_back(contact);
  }
  return mechanism;
}

/// Boxes standing on each other, the lowest on the ground.
Mechanism stack(int count, ContactMotion motion) {
  Mechanism mechanism = bodies(static_cast<std::size_t>(count), Vec3(0.01, 0.02, 0.03));
  for (int body = 0; body < count; ++body)
    for (ContactConstraint contact : box(4, motion).contacts) {
      contact.centerA.body = body;
      contact.surfaceB.body = body - 1;
      if (body > 0) contact.surfaceB.point.y() = 0.1;
      mechanism.contacts.push_back(contact);
    }
  return mechanism;
}

void evaluate(benchmark::State& loop, Mechanism mechanism, bool hasContacts) {
  if (!hasContacts) mechanism.contacts.clear();
  const Eigen::Index count = static_cast<Eigen::Index>(mechanism.bodies.size());
  VectorX state = VectorX::Zero(stateSize(count)), rate;
  for (Eigen::Index body = 0; body < count; ++body) {
    setOrientation(state, body, Quat::Identity());
    centerOfMass(state, body) = Vec3(static_cast<double>(body), 0.1, 0);
    linearVelocity(state, body) = Vec3(1, 0, 0.3);
    angularVelocity(state, body) = Vec3(0, 2, 0);
  }
  EquationsOfMotion equations(mechanism);
  for (auto _ : loop) {
    equations.evaluate(0, state, rate);
    benchmark::DoNotOptimize(rate.data());
  }
}

BENCHMARK_CAPTURE(evaluate, ball_free, balls(1, ContactMotion::sticking), false);
BENCHMARK_CAPTURE(evaluate, ball_frictionless, balls(1, ContactMotion::frictionless), true);
BENCHMARK_CAPTURE(evaluate, ball_sliding, balls(1, ContactMotion::sliding), true);
BENCHMARK_CAPTURE(evaluate, ball_rolling, balls(1, ContactMotion::sticking), true);
BENCHMARK_CAPTURE(evaluate, balls16_free, balls(16, ContactMotion::sticking), false);
BENCHMARK_CAPTURE(evaluate, balls16_rolling, balls(16, ContactMotion::sticking), true);
BENCHMARK_CAPTURE(evaluate, box_free, box(4, ContactMotion::sticking), false);
BENCHMARK_CAPTURE(evaluate, box_on_corner, box(1, ContactMotion::sticking), true);
BENCHMARK_CAPTURE(evaluate, box_frictionless, box(4, ContactMotion::frictionless), true);
BENCHMARK_CAPTURE(evaluate, box_sliding, box(4, ContactMotion::sliding), true);
BENCHMARK_CAPTURE(evaluate, box_on_edge_sticking, box(2, ContactMotion::sticking), true);
BENCHMARK_CAPTURE(evaluate, box_sticking, box(4, ContactMotion::sticking), true);
BENCHMARK_CAPTURE(evaluate, stack2_sticking, stack(2, ContactMotion::sticking), true);
BENCHMARK_CAPTURE(evaluate, stack5_sliding, stack(5, ContactMotion::sliding), true);
BENCHMARK_CAPTURE(evaluate, stack5_sticking, stack(5, ContactMotion::sticking), true);
BENCHMARK_CAPTURE(evaluate, stack10_sticking, stack(10, ContactMotion::sticking), true);

}  // namespace
}  // namespace cradle

BENCHMARK_MAIN();
