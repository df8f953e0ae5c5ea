#include "simulate/spheres/sphere_flights.h"

#include <algorithm>

#include "simulate/spheres/sphere_tolerances.h"

namespace cradle {
namespace {

constexpr double kMaxCellChange = 1.5;  // of the cells' size: then they are made anew

double timeLeft(double until, double now) {
  return std::max(0.0, until - now);
}

/// At most sqrt(3) times the speed, and no less than it.
double speedBound(const UniformMotion& motion) {
  return motion.velocity.lpNorm<1>();
}

/// All places within `distance` of a box's core.
Bounds boundsAround(const RoundedBox& box, double distance) {
  const RigidTransform worldFromBox = box.boxFromWorld.inverse();
  const Vec3 half = worldFromBox.rotation.toRotationMatrix().cwiseAbs() * box.halfSize + Vec3::Constant(distance);
  return {Vec3(worldFromBox.translation - half), Vec3(worldFromBox.translation + half)};
}

/// The earlier one; of two at once what has the smaller index, so that nothing depends on the order of the search.
void keepEarlier(double time, int other, long othersHits, PredictedCollision& best) {
  if (time < best.time || (time == best.time && other < best.other)) best = {time, other, othersHits};
}

}  // namespace

SphereFlights::SphereFlights(const SphereWorld& world, double duration)
    : world_(world),
      duration_(duration),
      flights_(world.starts.size()),
      largestRadius_(*std::max_element(world.radii.begin(), world.radii.end())) {
  for (std::size_t sphere = 0; sphere < flights_.size(); ++sphere) flights_[sphere].motion = world.starts[sphere];
  cells_ = cellsAt(0);
}

SphereCells SphereFlights::cellsAt(double now) const {
  std::vector<Vec3> centers;
  for (int sphere = 0; sphere < world_.sphereCount(); ++sphere) centers.push_back(positionAt(sphere, now));
  SphereCells cells(centers, largestRadius_, world_.boxes.size());
  for (std::size_t i = 0; i < world_.boxes.size(); ++i)
    cells.addFixed(static_cast<int>(i), boundsAround(world_.boxes[i], largestRadius_ + world_.boxes[i].radius));
  return cells;
}

bool SphereFlights::renewCells(double now) {
  if (!cells_.isBounded()) return false;
  SphereCells cells = cellsAt(now);
  const double change = cells.size() / cells_.size();
  if (change < kMaxCellChange && change > 1 / kMaxCellChange) return false;
  cells_ = std::move(cells);
  return true;
}

std::vector<SphereFlights::Record> SphereFlights::record() const {
  return {flights_.begin(), flights_.end()};
}

void SphereFlights::goOnFrom(const std::vector<Record>& records, double now, double duration) {
  for (std::size_t sphere = 0; sphere < flights_.size(); ++sphere) flights_[sphere] = {records.at(sphere), 0};
  duration_ = duration;
  cells_ = cellsAt(now);
}

void SphereFlights::shiftTime(double origin) {
  for (Flight& flight : flights_) flight.since -= origin;
  duration_ -= origin;
}

UniformMotion SphereFlights::motionAt(int sphere, double time) const {
  const Flight& flight = flights_[static_cast<std::size_t>(sphere)];
  return flight.motion.after(time - flight.since);
}

void SphereFlights::strike(int sphere, double time, const UniformMotion& motion, const std::array<int, 3>& supports) {
  Flight& flight = flights_[static_cast<std::size_t>(sphere)];
  flight = {{motion, time, supports}, flight.hits + 1};
}

PredictedCollision SphereFlights::nextCollision(int sphere, double now, double crossing) const {
  PredictedCollision best;
  const UniformMotion motion = motionAt(sphere, now);
  predictAgainstPlanes(motion, sphere, now, best);
  predictAgainstBoxes(motion, sphere, now, crossing, best);
  cells_.visitNear(sphere, [&](int other) { predictAgainstSphere(motion, sphere, other, now, best); });
  return best;
}

PredictedCollision SphereFlights::nextCollisionAhead(int sphere, const CellCrossing& crossing, double next) const {
  PredictedCollision best;
  const UniformMotion motion = motionAt(sphere, crossing.time);
  predictAgainstBoxes(motion, sphere, crossing.time, next, best);
  cells_.visitAhead(sphere, crossing.axis, crossing.step,
                    [&](int other) { predictAgainstSphere(motion, sphere, other, crossing.time, best); });
  return best;
}

void SphereFlights::predictAgainstSphere(const UniformMotion& motion, int sphere, int other, double now,
                                         PredictedCollision& best) const {
  if (other == sphere) return;
  const Flight& flight = flights_[static_cast<std::size_t>(other)];
  const UniformMotion theirs = flight.motion.after(now - flight.since);
  const UniformMotion relative = theirs.relativeTo(motion);
  if (relative.acceleration.isZero(0) && relative.position.dot(relative.velocity) >= 0) return;
  const double slowest = SphereTolerances::minClosingSpeed(speedBound(motion) + speedBound(theirs));
  const double time = timeToDistance(relative, radiusOf(sphere) + radiusOf(other), {slowest, timeLeft(duration_, now)});
  keepEarlier(now + time, other, flight.hits, best);
}

void SphereFlights::predictAgainstPlanes(const UniformMotion& motion, int sphere, double now,
                                         PredictedCollision& best) const {
  const auto& supports = flights_[static_cast<std::size_t>(sphere)].supports;
  const ContactSearch search{SphereTolerances::minClosingSpeed(speedBound(motion)), timeLeft(duration_, now)};
  for (int plane = 0; plane < world_.planeCount(); ++plane) {
    if (std::find(supports.begin(), supports.end(), plane) != supports.end()) continue;
    const auto index = static_cast<std::size_t>(plane);
    keepEarlier(now + timeToContact(motion, radiusOf(sphere), world_.planes[index], search), ~plane, 0, best);
  }
}

void SphereFlights::predictAgainstBoxes(const UniformMotion& motion, int sphere, double now, double until,
                                        PredictedCollision& best) const {
  const ContactSearch search{SphereTolerances::minClosingSpeed(speedBound(motion)),
                             timeLeft(std::min(until, duration_), now)};
  for (const int box : cells_.fixedNear(sphere)) {
    const double time = timeToContact(motion, radiusOf(sphere), world_.boxes[static_cast<std::size_t>(box)], search);
    keepEarlier(now + time, ~(world_.planeCount() + box), 0, best);
  }
}

CellCrossing SphereFlights::nextCrossing(int sphere, double now) const {
  CellCrossing first;
  if (!cells_.isBounded()) return first;
  const UniformMotion motion = motionAt(sphere, now);
  const Cell& cell = cells_.cellOf(sphere);
  for (int axis = 0; axis < 3; ++axis) {
    const long place = cell[static_cast<std::size_t>(axis)];
    for (const int step : {-1, 1}) {
      const double gap = step * (cells_.sideOf(place + (step + 1) / 2, axis) - motion.position[axis]);
      const double time = now + timeToClose(gap, -step * motion.velocity[axis], -step * motion.acceleration[axis]);
      if (time < first.time) first = {time, axis, step};
    }
  }
  return first;
}

bool SphereFlights::holds(const PredictedCollision& collision) const {
  return collision.other < 0 || collision.othersHits == hits(collision.other);
}

double SphereFlights::touchingGap(int sphere, int other) const {
  return SphereTolerances::touch(other < 0 ? radiusOf(sphere) : std::min(radiusOf(sphere), radiusOf(other)));
}

SphereContact SphereFlights::contactOf(int sphere, int other, double now) const {
  const Vec3 center = positionAt(sphere, now);
  SphereContact contact{sphere, other, 0, Vec3::UnitY(), Vec3::Zero()};
  if (other >= 0) {
    const Vec3 towards = positionAt(other, now) - center;
    const double distance = towards.norm();
    if (distance > 0) contact.normal = towards / distance;
    contact.gap = distance - radiusOf(sphere) - radiusOf(other);
  } else {
    const int obstacle = ~other;
    const Nearness nearness =
        obstacle < world_.planeCount()
            ? nearnessOf(center, world_.planes[static_cast<std::size_t>(obstacle)])
            : nearnessOf(center, world_.boxes[static_cast<std::size_t>(obstacle - world_.planeCount())]);
    contact.normal = -nearness.outward;
    contact.gap = nearness.distance - radiusOf(sphere);
  }
  contact.point = center + (radiusOf(sphere) + contact.gap / 2) * contact.normal;
  return contact;
}

void SphereFlights::appendTouching(int sphere, double now, std::vector<SphereContact>& contacts) const {
  const Vec3 center = positionAt(sphere, now);
  cells_.visitNear(sphere, [&](int other) {
    const double reach = radiusOf(sphere) + radiusOf(other) + touchingGap(sphere, other);
    if ((positionAt(other, now) - center).squaredNorm() <= reach * reach && other != sphere)
      contacts.push_back(contactOf(sphere, other, now));
  });
  const double reach = radiusOf(sphere) + touchingGap(sphere, kNoPartner);
  for (int plane = 0; plane < world_.planeCount(); ++plane)
    if (nearnessOf(center, world_.planes[static_cast<std::size_t>(plane)]).distance <= reach)
      contacts.push_back(contactOf(sphere, ~plane, now));
  for (const int box : cells_.fixedNear(sphere))
    if (nearnessOf(center, world_.boxes[static_cast<std::size_t>(box)]).distance <= reach)
      contacts.push_back(contactOf(sphere, ~(world_.planeCount() + box), now));
}

}  // namespace cradle
