// How slow sliding may become. Notation: v the speed of sliding, a its acceleration, mu the dynamic friction, g the
// largest acceleration at contacts, A the accuracy asked, T the duration of the run, e = A / 10 the error of velocities
// that steps allow.
//
// The error e turns the friction by the angle e / v, which takes mu g (e / v)^2 / 2 of the deceleration, and half of
// that times T^2 of the way. That exceeds A below v = T sqrt(mu g A) / 20. A sphere is exempt, as it soon rolls.
//
// Friction turns the direction of sliding at a rate of mu g / v, which steps of some 6 v / (mu g) follow at the most:
// sliding below kTurningTime mu g costs too much.
//
// A contact that starts from rest with the acceleration a passes through v = e sqrt(mu g / (2 a)), below which these
// errors outweigh a. That takes the time v / a: of the accuracy it costs T / 30 sqrt(mu g / (2 a)) at A = 1e-4
// (measured: a block on a slope), and less at finer accuracies. Below a = mu g / 50 the contact may never get through,
// as errors have time to grow to e.
//
// Where a changes at the rate j, as on a table that swings, it is below mu g / 50 for mu g / (50 |j|). In a twentieth
// of the run errors come to e / 20, which takes of the deceleration 1 / 400 of what e would: that is no creeping.
//
// Friction that follows the direction of such sliding asks for some mu g / (3 j t) steps from t on, with v = j t^2 / 2.
// It keeps its direction while the contact slides by A / 100 or 2 A / 100: the way across is no longer, and friction
// takes the velocity across within v / (mu g) then. With A / 100 = j t^2 / 6 these are mu g t^2 / (18 A / 100) steps.

#include "simulate/events/slow_sliding.h"

#include <algorithm>
#include <cmath>

#include "constraints/contact_rows.h"
#include "math/elementary.h"

namespace cradle {
namespace {

constexpr double kShortCreeping = 0.05;  // of the run
constexpr double kKeptWay = 0.01;        // of A, in m: a way that is no part of the errors
constexpr double kTurningTime = 2e-5;    // s: friction that turns sliding as fast costs 4 s of CPU a second

/// m/s: of the surfaces along each other.
double slidingSpeed(const Contact& contact, const VectorX& state) {
  const Vec3 velocity = relativeVelocity(contact, state);
  return (velocity - contact.normal.dot(velocity) * contact.normal).norm();
}

}  // namespace

bool slidesTooSlowly(const ContactRecord& record, const SlidingAccelerations& accelerations,
                     const EventTolerances& tolerances, const IslandState& island) {
  const double friction = record.pair.material.dynamicFriction * accelerations.largest;  // m/s^2: mu g
  const double acceleration = accelerations.sliding;
  const std::vector<Collider>& colliders = island.assembly.geometry.colliders;
  const bool rolls =
      colliders[record.pair.a].isSphere() || (!record.pair.againstPlane && colliders[record.pair.b].isSphere());
  const double slowest = std::max(rolls ? 0 : tolerances.minSlidingSpeed(friction), kTurningTime * friction);
  const double speed = slidingSpeed(record.contact, island.state);
  const double creeping = tolerances.minSlidingAcceleration(friction);
  const double accuracy = tolerances.scales.accuracy, duration = tolerances.scales.duration;
  const double passed = accuracy * std::sqrt(friction / (2 * std::max(acceleration, creeping)));  // m/s: ten times v
  const double change = std::abs(accelerations.change);
  const double reached = speed + (acceleration + change * duration / 2) * duration;
  return reached < slowest ||
         (!rolls && speed < passed && acceleration < creeping && kShortCreeping * duration * change < creeping);
}

double timeOfKeptDirection(const SlidingAccelerations& accelerations, const EventTolerances& tolerances) {
  const double way = kKeptWay * tolerances.scales.accuracy;  // m: a t^2 / 2, or j t^3 / 6
  return std::min(std::sqrt(2 * way / accelerations.sliding), exp(log(6 * way / std::abs(accelerations.change)) / 3));
}

double stepsAfterKeptDirection(const ContactRecord& record, double time, const EventTolerances& tolerances) {
  const double kept = record.keepsDirectionUntil - time;
  const double friction = record.pair.material.dynamicFriction * record.force / record.mass;  // m/s^2: mu g
  return friction * kept * kept / (18 * kKeptWay * tolerances.scales.accuracy);
}

bool isDirectionTurnedFast(const ContactRecord& record, double speed, double normal) {
  return speed < kTurningTime * record.pair.material.dynamicFriction * normal / record.mass;
}

}  // namespace cradle
