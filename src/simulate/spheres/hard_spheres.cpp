// B. J. Alder, T. E. Wainwright, "Studies in Molecular Dynamics I. General Method", J. Chem. Phys. 31, 1959; one event
// a sphere, predicted anew when its partner was struck meanwhile: B. D. Lubachevsky, "How to simulate billiards and
// similar systems", J. Comput. Phys. 94, 1991. Of each pair the sphere that was predicted last knows both motions; it
// keeps the earliest of its own collisions only. A collision whose partner has been struck since is no event but the
// time of a new prediction: an earlier one would have been found by that partner.

#include "simulate/spheres/hard_spheres.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/interruption.h"
#include "impact/linear_complementarity.h"
#include "simulate/contact_wrenches.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kHitWindow = 1.0 / 960;      // s: of one contact step
constexpr long kMaxHits = 1000000;            // of a sphere in a window: a second of computing
constexpr long kEventsBetweenChecks = 10000;  // for a signal: some ms
constexpr long kEventsAnOrigin = 8;           // a sphere: moving the origin costs about one for each

/// The world with its spheres where the run begins: what the scene lets overlap has been moved apart.
SphereWorld placed(SphereWorld world, const VectorX& state) {
  for (int sphere = 0; sphere < world.sphereCount(); ++sphere)
    world.starts[static_cast<std::size_t>(sphere)].position = centerOfMass(state, sphere);
  return world;
}

}  // namespace

HardSpheres::HardSpheres(const Scene& scene, Assembly assembly, SphereWorld world)
    : scene_(scene),
      assembly_(std::move(assembly)),
      world_(placed(std::move(world), assembly_.state)),
      flights_(world_, scene.duration),
      impact_(world_, flights_),
      queue_(world_.sphereCount()),
      collisions_(world_.radii.size()),
      crossings_(world_.radii.size()),
      windows_(world_.radii.size()),
      state_(assembly_.state) {
  for (int sphere = 0; sphere < world_.sphereCount(); ++sphere)
    rotations_.emplace_back(assembly_.mechanism.bodies[static_cast<std::size_t>(sphere)].inertiaTensor,
                            RotationState{orientation(state_, sphere), angularVelocity(state_, sphere)});
  impact_.begin();
  for (int sphere = 0; sphere < world_.sphereCount(); ++sphere) predict(sphere);
}

HardSpheres::HardSpheres(const Scene& scene, Assembly assembly, SphereWorld world, const Record& record)
    : HardSpheres(scene, std::move(assembly), std::move(world)) {
  state_ = record.state;
  origin_ = record.origin, originRest_ = record.originRest, time_ = record.time;
  flights_.goOnFrom(record.flights, time_, sinceOrigin(scene.duration));
  for (int sphere = 0; sphere < world_.sphereCount(); ++sphere) predict(sphere);
  evaluations_ = 0;
}

const VectorX& HardSpheres::stateAt(double time) {
  const double same = sameTime(time);
  while (queue_.firstTime() <= sinceOrigin(time) + same) advance();
  for (int sphere = 0; sphere < world_.sphereCount(); ++sphere) {
    const UniformMotion motion = flights_.motionAt(sphere, sinceOrigin(time));
    centerOfMass(state_, sphere) = motion.position;
    linearVelocity(state_, sphere) = motion.velocity;
    const RotationState turned = rotations_[static_cast<std::size_t>(sphere)].at(time);
    setOrientation(state_, sphere, turned.worldFromBody);
    angularVelocity(state_, sphere) = turned.angularVelocity;
  }
  evaluations_ += world_.sphereCount();
  return state_;
}

/// The next event: a cell crossing, a collision that is to be predicted anew, or one that holds.
void HardSpheres::advance() {
  if (++evaluations_ % kEventsBetweenChecks == 0) throwIfInterrupted();
  if (++eventsSinceOrigin_ > kEventsAnOrigin * world_.sphereCount()) moveOrigin();
  const int sphere = queue_.first();
  const auto index = static_cast<std::size_t>(sphere);
  time_ = std::max(time_, queue_.firstTime());
  if (crossings_[index].time < collisions_[index].time)
    cross(sphere);
  else if (flights_.holds(collisions_[index]))
    collide(sphere);
  else
    predict(sphere);
}

/// Times are counted from a recent event, or they would lose digits as they grow.
void HardSpheres::moveOrigin() {
  eventsSinceOrigin_ = 0;
  const double sum = origin_ + (originRest_ + time_);
  originRest_ = (origin_ - sum) + (originRest_ + time_);
  origin_ = sum;
  flights_.shiftTime(time_);
  for (Window& window : windows_) window.start -= time_;
  for (PredictedCollision& collision : collisions_) collision.time -= time_;
  for (CellCrossing& crossing : crossings_) crossing.time -= time_;
  time_ = 0;
  const bool isVoid = flights_.renewCells(0);
  for (int sphere = 0; sphere < world_.sphereCount(); ++sphere) isVoid ? predict(sphere) : schedule(sphere);
}

void HardSpheres::cross(int sphere) {
  const auto index = static_cast<std::size_t>(sphere);
  const CellCrossing crossing = crossings_[index];
  flights_.cross(sphere, crossing);
  crossings_[index] = flights_.nextCrossing(sphere, time_);
  const PredictedCollision ahead = flights_.nextCollisionAhead(sphere, crossing, crossings_[index].time);
  if (ahead.time < collisions_[index].time) collisions_[index] = ahead;
  schedule(sphere);
}

void HardSpheres::collide(int sphere) {
  impact_.resolve(sphere, collisions_[static_cast<std::size_t>(sphere)].other, time_);
  refuseLastingContact();
  impactEnergy(state_) += impact_.energyTaken();
  numericalEnergy(state_) += impact_.energyLost();
  addEvents();
  for (const int struck : impact_.spheres()) countHit(struck);
  for (const int struck : impact_.spheres()) predict(struck);
}

void HardSpheres::predict(int sphere) {
  const auto index = static_cast<std::size_t>(sphere);
  crossings_[index] = flights_.nextCrossing(sphere, time_);
  collisions_[index] = flights_.nextCollision(sphere, time_, crossings_[index].time);
  schedule(sphere);
}

void HardSpheres::schedule(int sphere) {
  const auto index = static_cast<std::size_t>(sphere);
  queue_.set(sphere, std::min(crossings_[index].time, collisions_[index].time));
}

void HardSpheres::addEvents() {
  for (std::size_t i = 0; i < impact_.contacts().size(); ++i) {
    const SphereContact& contact = impact_.contacts()[i];
    const double impulse = impact_.impulses()[i];
    if (impulse <= 0) continue;
    int a = sceneBodyOf(contact.sphere), b = sceneBodyOf(contact.other);
    const bool isPlane = contact.other < 0 && ~contact.other < world_.planeCount();
    const bool swaps = b < a && !isPlane;  // planes stand second
    if (swaps) std::swap(a, b);
    events_.push_back({timeSinceStart(), EventKind::impact, a, b, contact.point,
                       swaps ? Vec3(-contact.normal) : contact.normal, impulse});
  }
}

/// Bounces that become ever faster would never let time go on.
void HardSpheres::countHit(int sphere) {
  Window& window = windows_[static_cast<std::size_t>(sphere)];
  if (time_ > window.start + kHitWindow) window = {time_, 0};
  if (++window.hits <= kMaxHits) return;
  throw Error(ErrorKind::limit, scene_.path,
              fmt::format("\"{}\" is hit more than {} times within {:.3g} s at {:.6g} s: without loss this may have no "
                          "end; lower its \"restitution\", or name a \"method\", such as \"rk4\"",
                          nameOf(sphere), kMaxHits, kHitWindow, timeSinceStart()));
}

void HardSpheres::refuseLastingContact() const {
  const auto contact = world_.gravity.isZero(0) ? std::nullopt : impact_.lastingContact();
  if (!contact) return;
  throw Error(ErrorKind::limit, scene_.path,
              fmt::format("\"{}\" comes to lie on \"{}\" at {:.6g} s, which is no flight between collisions; name a "
                          "\"method\", such as \"rk4\"",
                          nameOf(contact->sphere), nameOf(contact->other), timeSinceStart()));
}

int HardSpheres::sceneBodyOf(int other) const {
  return other < 0 ? world_.obstacleBodies[static_cast<std::size_t>(~other)]
                   : world_.sceneBodies[static_cast<std::size_t>(other)];
}

std::string HardSpheres::nameOf(int other) const {
  return scene_.bodies[static_cast<std::size_t>(sceneBodyOf(other))].name;
}

std::vector<ContactWrench> HardSpheres::contactWrenches() const {
  WrenchSum sum;
  for (int sphere = 0; sphere < world_.sphereCount(); ++sphere) {
    const auto index = static_cast<std::size_t>(sphere);
    const std::array<int, 3>& supports = flights_.supports(sphere);
    const auto count = std::ranges::find(supports, -1) - supports.begin();
    if (count == 0) continue;
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> normals(3, count);
    for (Eigen::Index i = 0; i < count; ++i)
      normals.col(i) = world_.planes[static_cast<std::size_t>(supports[static_cast<std::size_t>(i)])].normal;
    const Vec3 carried = (flights_.motionAt(sphere, time_).acceleration - world_.gravity) / world_.inverseMasses[index];
    const Vec3 center = centerOfMass(state_, sphere);
    const VectorX forces = solveLinearComplementarity(normals.transpose() * normals, -normals.transpose() * carried);
    for (Eigen::Index i = 0; i < count; ++i) {
      const int plane = supports[static_cast<std::size_t>(i)];
      const Vec3 normal = normals.col(i);
      if (forces[i] > 0)
        sum.add({world_.sceneBodies[index], sceneBodyOf(~plane), center - world_.radii[index] * normal, forces[i],
                 -forces[i] * normal, Vec3::Zero()});
    }
  }
  return sum.wrenches();
}

std::vector<Event> HardSpheres::takeEvents() {
  return std::exchange(events_, {});
}

std::optional<SphereWorld> hardSpheresOf(const Scene& scene, const IslandPlan& island) {
  std::optional<SphereWorld> world = sphereWorldOf(scene, island);
  if (!world) return std::nullopt;
  SphereFlights flights(*world, scene.duration);
  SphereImpact impact(*world, flights);
  impact.begin();
  if (!world->gravity.isZero(0) && impact.lastingContact()) return std::nullopt;
  return world;
}

}  // namespace cradle
