// B. J. Alder, T. E. Wainwright, "Studies in Molecular Dynamics I. General Method", J. Chem. Phys. 31, 1959; one event
// a ball, looked into again when its partner was struck meanwhile: B. D. Lubachevsky, "How to simulate billiards and
// similar systems", J. Comput. Phys. 94, 1991. Of each pair the ball that was foreseen last knows both motions; it
// keeps the earliest of its own meetings only. A meeting whose partner has been struck since is no event but the time
// to look again: what comes before it would have been foreseen by that partner.

#include "simulate/balls/flying_balls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/interruption.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kHitWindow = 1.0 / 960;      // s
constexpr long kMostHits = 1000000;           // of a ball in a window: a second of computing
constexpr long kEventsBetweenChecks = 10000;  // for a signal: some ms
constexpr long kEventsAnOrigin = 8;           // a ball: moving the origin costs about one for each

/// The world with its balls where the run begins: what the scene lets overlap has been moved apart.
BallWorld placed(BallWorld world, const VectorX& state) {
  for (int ball = 0; ball < world.ballCount(); ++ball)
    world.starts[static_cast<std::size_t>(ball)].position = centerOfMass(state, ball);
  return world;
}

}  // namespace

FlyingBalls::FlyingBalls(const Scene& scene, Assembly assembly, BallWorld world)
    : scene_(scene),
      assembly_(std::move(assembly)),
      world_(placed(std::move(world), assembly_.state)),
      flights_(world_, scene.duration),
      impact_(world_, flights_),
      queue_(world_.ballCount()),
      meetings_(world_.radii.size()),
      crossings_(world_.radii.size()),
      windows_(world_.radii.size()),
      state_(assembly_.state) {
  for (int ball = 0; ball < world_.ballCount(); ++ball)
    rotations_.emplace_back(assembly_.mechanism.bodies[static_cast<std::size_t>(ball)].inertiaTensor,
                            RotationState{orientation(state_, ball), angularVelocity(state_, ball)});
  impact_.begin();
  for (int ball = 0; ball < world_.ballCount(); ++ball) foresee(ball);
}

const VectorX& FlyingBalls::stateAt(double time) {
  const double same = sameTime(time);
  while (queue_.firstTime() <= sinceOrigin(time) + same) advance();
  for (int ball = 0; ball < world_.ballCount(); ++ball) {
    const UniformMotion motion = flights_.motionAt(ball, sinceOrigin(time));
    centerOfMass(state_, ball) = motion.position;
    linearVelocity(state_, ball) = motion.velocity;
    const RotationState turned = rotations_[static_cast<std::size_t>(ball)].at(time);
    setOrientation(state_, ball, turned.worldFromBody);
    angularVelocity(state_, ball) = turned.angularVelocity;
  }
  evaluations_ += world_.ballCount();
  return state_;
}

/// The next event: a way out of a cell, a meeting to look into again, or a collision.
void FlyingBalls::advance() {
  if (++evaluations_ % kEventsBetweenChecks == 0) throwIfInterrupted();
  if (++eventsSinceOrigin_ > kEventsAnOrigin * world_.ballCount()) moveOrigin();
  const int ball = queue_.first();
  const auto index = static_cast<std::size_t>(ball);
  time_ = std::max(time_, queue_.firstTime());
  if (crossings_[index].time < meetings_[index].time)
    cross(ball);
  else if (flights_.holds(meetings_[index]))
    collide(ball);
  else
    foresee(ball);
}

/// Times are counted from a recent event, or they would lose digits as they grow.
void FlyingBalls::moveOrigin() {
  eventsSinceOrigin_ = 0;
  const double sum = origin_ + (originRest_ + time_);
  originRest_ = (origin_ - sum) + (originRest_ + time_);
  origin_ = sum;
  flights_.shiftTime(time_);
  for (Window& window : windows_) window.start -= time_;
  for (Meeting& meeting : meetings_) meeting.time -= time_;
  for (Crossing& crossing : crossings_) crossing.time -= time_;
  time_ = 0;
  const bool isVoid = flights_.renewCells(0);
  for (int ball = 0; ball < world_.ballCount(); ++ball) isVoid ? foresee(ball) : schedule(ball);
}

void FlyingBalls::cross(int ball) {
  const auto index = static_cast<std::size_t>(ball);
  const Crossing crossing = crossings_[index];
  flights_.cross(ball, crossing);
  crossings_[index] = flights_.nextCrossing(ball, time_);
  const Meeting ahead = flights_.nextMeetingAhead(ball, crossing, crossings_[index].time);
  if (ahead.time < meetings_[index].time) meetings_[index] = ahead;
  schedule(ball);
}

void FlyingBalls::collide(int ball) {
  impact_.resolve(ball, meetings_[static_cast<std::size_t>(ball)].other, time_);
  refuseLastingContact();
  impactEnergy(state_) += impact_.energyTaken();
  numericalEnergy(state_) += impact_.energyLost();
  record();
  for (const int struck : impact_.balls()) countHit(struck);
  for (const int struck : impact_.balls()) foresee(struck);
}

void FlyingBalls::foresee(int ball) {
  const auto index = static_cast<std::size_t>(ball);
  crossings_[index] = flights_.nextCrossing(ball, time_);
  meetings_[index] = flights_.nextMeeting(ball, time_, crossings_[index].time);
  schedule(ball);
}

void FlyingBalls::schedule(int ball) {
  const auto index = static_cast<std::size_t>(ball);
  queue_.set(ball, std::min(crossings_[index].time, meetings_[index].time));
}

void FlyingBalls::record() {
  for (std::size_t i = 0; i < impact_.contacts().size(); ++i) {
    const BallContact& contact = impact_.contacts()[i];
    const double impulse = impact_.impulses()[i];
    if (impulse <= 0) continue;
    int a = sceneBodyOf(contact.ball), b = sceneBodyOf(contact.other);
    const bool isPlane = contact.other < 0 && ~contact.other < world_.planeCount();
    const bool swaps = b < a && !isPlane;  // planes stand second
    if (swaps) std::swap(a, b);
    events_.push_back({timeSinceStart(), EventKind::impact, a, b, contact.point,
                       swaps ? Vec3(-contact.normal) : contact.normal, impulse});
  }
}

/// Bounces that become ever faster would never let time go on.
void FlyingBalls::countHit(int ball) {
  Window& window = windows_[static_cast<std::size_t>(ball)];
  if (time_ > window.start + kHitWindow) window = {time_, 0};
  if (++window.hits <= kMostHits) return;
  throw Error(ErrorKind::limit, scene_.path,
              fmt::format("\"{}\" is hit more than {} times within {:.3g} s at {:.6g} s: without loss this may have no "
                          "end; lower its \"restitution\", or name a \"method\", such as \"rk4\"",
                          nameOf(ball), kMostHits, kHitWindow, timeSinceStart()));
}

void FlyingBalls::refuseLastingContact() const {
  const auto contact = world_.gravity.isZero(0) ? std::nullopt : impact_.lastingContact();
  if (!contact) return;
  throw Error(ErrorKind::limit, scene_.path,
              fmt::format("\"{}\" comes to lie on \"{}\" at {:.6g} s, which is no flight between collisions; name a "
                          "\"method\", such as \"rk4\"",
                          nameOf(contact->ball), nameOf(contact->other), timeSinceStart()));
}

int FlyingBalls::sceneBodyOf(int other) const {
  return other < 0 ? world_.obstacleBodies[static_cast<std::size_t>(~other)]
                   : world_.sceneBodies[static_cast<std::size_t>(other)];
}

std::string FlyingBalls::nameOf(int other) const {
  return scene_.bodies[static_cast<std::size_t>(sceneBodyOf(other))].name;
}

std::vector<Event> FlyingBalls::takeEvents() {
  return std::exchange(events_, {});
}

std::optional<BallWorld> flyingBallsOf(const Scene& scene, const IslandPlan& island) {
  std::optional<BallWorld> world = ballWorldOf(scene, island);
  if (!world) return std::nullopt;
  BallFlights flights(*world, scene.duration);
  BallImpact impact(*world, flights);
  impact.begin();
  if (!world->gravity.isZero(0) && impact.lastingContact()) return std::nullopt;
  return world;
}

}  // namespace cradle
