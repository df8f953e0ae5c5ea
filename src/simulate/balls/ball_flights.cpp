#include "simulate/balls/ball_flights.h"

#include <algorithm>

namespace cradle {
namespace {

constexpr double kSlowPart = 1e-14;  // of the speeds: what touches and closes more slowly does so by rounding

// Of the smaller radius: nearer is touching. Places are known to rounding at any accuracy, and of balls of different
// masses the order of collisions counts.
constexpr double kBallTouchPart = 1e-11;

constexpr double kMostChange = 1.5;  // of the cells' size: then they are made anew

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
void keepEarlier(double time, int other, long othersHits, Meeting& best) {
  if (time < best.time || (time == best.time && other < best.other)) best = {time, other, othersHits};
}

}  // namespace

BallFlights::BallFlights(const BallWorld& world, double duration)
    : world_(world),
      duration_(duration),
      flights_(world.starts.size()),
      largestRadius_(*std::max_element(world.radii.begin(), world.radii.end())) {
  for (std::size_t ball = 0; ball < flights_.size(); ++ball) flights_[ball].motion = world.starts[ball];
  cells_ = cellsAt(0);
}

BallCells BallFlights::cellsAt(double now) const {
  std::vector<Vec3> centers;
  for (int ball = 0; ball < world_.ballCount(); ++ball) centers.push_back(positionAt(ball, now));
  BallCells cells(centers, largestRadius_, world_.boxes.size());
  for (std::size_t i = 0; i < world_.boxes.size(); ++i)
    cells.addFixed(static_cast<int>(i), boundsAround(world_.boxes[i], largestRadius_ + world_.boxes[i].radius));
  return cells;
}

bool BallFlights::renewCells(double now) {
  if (!cells_.isBounded()) return false;
  BallCells cells = cellsAt(now);
  const double change = cells.size() / cells_.size();
  if (change < kMostChange && change > 1 / kMostChange) return false;
  cells_ = std::move(cells);
  return true;
}

void BallFlights::shiftTime(double origin) {
  for (Flight& flight : flights_) flight.since -= origin;
  duration_ -= origin;
}

UniformMotion BallFlights::motionAt(int ball, double time) const {
  const Flight& flight = flights_[static_cast<std::size_t>(ball)];
  return flight.motion.after(time - flight.since);
}

void BallFlights::strike(int ball, double time, const UniformMotion& motion, const std::array<int, 3>& supports) {
  Flight& flight = flights_[static_cast<std::size_t>(ball)];
  flight = {motion, time, flight.hits + 1, supports};
}

Meeting BallFlights::nextMeeting(int ball, double now, double crossing) const {
  Meeting best;
  const UniformMotion motion = motionAt(ball, now);
  meetPlanes(motion, ball, now, best);
  meetBoxes(motion, ball, now, crossing, best);
  cells_.visitNear(ball, [&](int other) { meetBall(motion, ball, other, now, best); });
  return best;
}

Meeting BallFlights::nextMeetingAhead(int ball, const Crossing& crossing, double next) const {
  Meeting best;
  const UniformMotion motion = motionAt(ball, crossing.time);
  meetBoxes(motion, ball, crossing.time, next, best);
  cells_.visitAhead(ball, crossing.axis, crossing.step,
                    [&](int other) { meetBall(motion, ball, other, crossing.time, best); });
  return best;
}

void BallFlights::meetBall(const UniformMotion& motion, int ball, int other, double now, Meeting& best) const {
  if (other == ball) return;
  const Flight& flight = flights_[static_cast<std::size_t>(other)];
  const UniformMotion theirs = flight.motion.after(now - flight.since);
  const UniformMotion relative = theirs.relativeTo(motion);
  if (relative.acceleration.isZero(0) && relative.position.dot(relative.velocity) >= 0) return;
  const double slowest = kSlowPart * (speedBound(motion) + speedBound(theirs));
  const double time = timeToDistance(relative, radiusOf(ball) + radiusOf(other), {slowest, timeLeft(duration_, now)});
  keepEarlier(now + time, other, flight.hits, best);
}

void BallFlights::meetPlanes(const UniformMotion& motion, int ball, double now, Meeting& best) const {
  const auto& supports = flights_[static_cast<std::size_t>(ball)].supports;
  const ContactSearch search{kSlowPart * speedBound(motion), timeLeft(duration_, now)};
  for (int plane = 0; plane < world_.planeCount(); ++plane) {
    if (std::find(supports.begin(), supports.end(), plane) != supports.end()) continue;
    const auto index = static_cast<std::size_t>(plane);
    keepEarlier(now + timeToContact(motion, radiusOf(ball), world_.planes[index], search), ~plane, 0, best);
  }
}

void BallFlights::meetBoxes(const UniformMotion& motion, int ball, double now, double until, Meeting& best) const {
  const ContactSearch search{kSlowPart * speedBound(motion), timeLeft(std::min(until, duration_), now)};
  for (const int box : cells_.fixedNear(ball)) {
    const double time = timeToContact(motion, radiusOf(ball), world_.boxes[static_cast<std::size_t>(box)], search);
    keepEarlier(now + time, ~(world_.planeCount() + box), 0, best);
  }
}

Crossing BallFlights::nextCrossing(int ball, double now) const {
  Crossing first;
  if (!cells_.isBounded()) return first;
  const UniformMotion motion = motionAt(ball, now);
  const Cell& cell = cells_.cellOf(ball);
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

bool BallFlights::holds(const Meeting& meeting) const {
  return meeting.other < 0 || meeting.othersHits == hits(meeting.other);
}

double BallFlights::touchingGap(int ball, int other) const {
  return kBallTouchPart * (other < 0 ? radiusOf(ball) : std::min(radiusOf(ball), radiusOf(other)));
}

BallContact BallFlights::contactOf(int ball, int other, double now) const {
  const Vec3 center = positionAt(ball, now);
  BallContact contact{ball, other, 0, Vec3::UnitY(), Vec3::Zero()};
  if (other >= 0) {
    const Vec3 towards = positionAt(other, now) - center;
    const double distance = towards.norm();
    if (distance > 0) contact.normal = towards / distance;
    contact.gap = distance - radiusOf(ball) - radiusOf(other);
  } else {
    const int obstacle = ~other;
    const Nearness nearness =
        obstacle < world_.planeCount()
            ? nearnessOf(center, world_.planes[static_cast<std::size_t>(obstacle)])
            : nearnessOf(center, world_.boxes[static_cast<std::size_t>(obstacle - world_.planeCount())]);
    contact.normal = -nearness.outward;
    contact.gap = nearness.distance - radiusOf(ball);
  }
  contact.point = center + (radiusOf(ball) + contact.gap / 2) * contact.normal;
  return contact;
}

void BallFlights::appendTouching(int ball, double now, std::vector<BallContact>& contacts) const {
  const Vec3 center = positionAt(ball, now);
  cells_.visitNear(ball, [&](int other) {
    const double reach = radiusOf(ball) + radiusOf(other) + touchingGap(ball, other);
    if ((positionAt(other, now) - center).squaredNorm() <= reach * reach && other != ball)
      contacts.push_back(contactOf(ball, other, now));
  });
  const double reach = radiusOf(ball) + touchingGap(ball, kNothing);
  for (int plane = 0; plane < world_.planeCount(); ++plane)
    if (nearnessOf(center, world_.planes[static_cast<std::size_t>(plane)]).distance <= reach)
      contacts.push_back(contactOf(ball, ~plane, now));
  for (const int box : cells_.fixedNear(ball))
    if (nearnessOf(center, world_.boxes[static_cast<std::size_t>(box)]).distance <= reach)
      contacts.push_back(contactOf(ball, ~(world_.planeCount() + box), now));
}

}  // namespace cradle
