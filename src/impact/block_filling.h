#pragma once

#include "impact/contact_blocks.h"

// From manifolds to lanes of contact blocks, and back.

namespace cradle {

inline void setLane(LaneVector& lanes, int lane, const Vec3& value) {
  lanes.x[lane] = value.x(), lanes.y[lane] = value.y(), lanes.z[lane] = value.z();
}

/// One row of a lane: its turns, and the mass that it moves.
template <class Block>
double fillTurns(LaneVector (&turns)[Block::kMovers], const Vec3& direction, const Vec3 (&arms)[Block::kMovers],
                 const SolverBody* const (&bodies)[Block::kMovers], int lane) {
  double inverseMass = 0;
  for (int k = 0; k < Block::kMovers; ++k) {
    const Vec3 turn = bodies[k]->scaledFromWorld * arms[k].cross(direction);
    setLane(turns[k], lane, turn);
    inverseMass += bodies[k]->inverseMass + turn.squaredNorm();
  }
  return inverseMass;
}

/// Product of two rows' turns.
template <class Block>
double couplingOf(const LaneVector (&a)[Block::kMovers], const LaneVector (&b)[Block::kMovers], int lane) {
  double sum = 0;
  for (int k = 0; k < Block::kMovers; ++k) sum += dot(a[k], b[k])[lane];
  return sum;
}

/// Moment arms (m) of a manifold's points and their middle, of each mover.
template <class Block>
struct ArmsOf {
  Vec3 points[Block::kPoints][Block::kMovers];
  Vec3 middle[Block::kMovers];

  ArmsOf(const PersistentManifold& manifold, const SolverBody* const (&bodies)[Block::kMovers]) {
    for (int k = 0; k < Block::kMovers; ++k) {
      const auto& anchors = k == 0 ? manifold.onA : manifold.onB;
      Vec3 sum = Vec3::Zero();
      for (int i = 0; i < Block::kPoints; ++i)
        sum += points[i][k] = bodies[k]->worldFromBody * anchors[static_cast<std::size_t>(i)].template cast<double>();
      middle[k] = sum / Block::kPoints;
    }
  }

  /// From the middle, seen from both bodies alike.
  Vec3 fromMiddle(int point) const {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < Block::kMovers; ++k) sum += points[point][k] - middle[k];
    return sum / Block::kMovers;
  }
};

/// The rows of the contact plane: a point at (u, v) turns the bodies by turns + u slopeTurns[0] + v slopeTurns[1].
template <class Block>
void fillPlane(const PersistentManifold& manifold, const ArmsOf<Block>& arms,
               const SolverBody* const (&bodies)[Block::kMovers], const Vec3 (&tangents)[2], int lane, Block& block) {
  auto& plane = block.plane;
  const double inverseMass = fillTurns<Block>(plane.turns, manifold.normal, arms.middle, bodies, lane);
  if constexpr (Block::kPoints == 1) {
    block.points[0].mass[lane] = 1 / inverseMass;
  } else {
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < Block::kMovers; ++k)
        setLane(plane.slopeTurns[i][k], lane, bodies[k]->scaledFromWorld * tangents[i].cross(manifold.normal));
    Mat3 operatorOfRows;
    operatorOfRows(0, 0) = inverseMass;
    for (int i = 0; i < 2; ++i) {
      operatorOfRows(0, i + 1) = couplingOf<Block>(plane.turns, plane.slopeTurns[i], lane);
      for (int j = i; j < 2; ++j)
        operatorOfRows(i + 1, j + 1) = couplingOf<Block>(plane.slopeTurns[i], plane.slopeTurns[j], lane);
    }
    const Mat3 delassus = operatorOfRows.selfadjointView<Eigen::Upper>(), inertia = delassus.inverse();
    plane.inertia.xx[lane] = inertia(0, 0), plane.inertia.xy[lane] = inertia(0, 1);
    plane.inertia.xz[lane] = inertia(0, 2), plane.inertia.yy[lane] = inertia(1, 1);
    plane.inertia.yz[lane] = inertia(1, 2), plane.inertia.zz[lane] = inertia(2, 2);
    for (int i = 0; i < Block::kPoints; ++i) {
      auto& point = block.points[i];
      const Vec3 arm = arms.fromMiddle(i), place(1, arm.dot(tangents[0]), arm.dot(tangents[1]));
      point.u[lane] = place[1], point.v[lane] = place[2];
      point.mass[lane] = 1 / place.dot(delassus * place);
    }
  }
}

template <class Block>
void fillFriction(const PersistentManifold& manifold, const ArmsOf<Block>& arms,
                  const SolverBody* const (&bodies)[Block::kMovers], const Vec3 (&tangents)[2], double subStep,
                  int lane, Block& block) {
  auto& friction = block.friction;
  double inverse[2];
  for (int i = 0; i < 2; ++i) {
    setLane(friction.tangents[i], lane, tangents[i]);
    inverse[i] = fillTurns<Block>(friction.turns[i], tangents[i], arms.middle, bodies, lane);
    friction.totals[i][lane] = 0;
    friction.impulses[i][lane] = subStep * manifold.frictionForce.dot(tangents[i]);
  }
  const double coupling = couplingOf<Block>(friction.turns[0], friction.turns[1], lane);
  const double determinant = inverse[0] * inverse[1] - coupling * coupling;
  friction.mass11[lane] = inverse[1] / determinant;
  friction.mass12[lane] = -coupling / determinant;
  friction.mass22[lane] = inverse[0] / determinant;
  friction.coefficient[lane] = manifold.friction;

  if constexpr (Block::kPoints > 1) {
    double inverseTwist = 0;
    for (int k = 0; k < Block::kMovers; ++k) {
      const Vec3 turn = bodies[k]->scaledFromWorld * manifold.normal;
      setLane(block.twist.turns[k], lane, turn);
      inverseTwist += turn.squaredNorm();
    }
    block.twist.mass[lane] = 1 / inverseTwist;
    block.twist.total[lane] = 0;
    block.twist.impulse[lane] = subStep * manifold.twist;
    for (int i = 0; i < Block::kPoints; ++i) block.twist.levers[i][lane] = (arms.points[i][0] - arms.middle[0]).norm();
  }
}

/// Puts a manifold of the block's kind into one lane, with the impulses of its last forces in `subStep` (s).
template <class Block>
void fillLane(const PersistentManifold& manifold, std::int32_t index, const std::vector<SolverBody>& bodies,
              double subStep, int lane, Block& block) {
  const int indices[2] = {manifold.bodyA, manifold.bodyB};
  const SolverBody* movers[Block::kMovers];
  for (int k = 0; k < Block::kMovers; ++k) {
    movers[k] = &bodies[static_cast<std::size_t>(indices[k])];
    block.bodies[k][lane] = indices[k];
    block.inverseMasses[k][lane] = movers[k]->inverseMass;
  }
  block.manifolds[lane] = index;
  setLane(block.normal, lane, manifold.normal);
  block.restitution[lane] = manifold.material->restitution;
  for (int i = 0; i < Block::kPoints; ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    block.points[i].separation[lane] = manifold.separations[at];
    block.points[i].total[lane] = 0;
    block.points[i].impulse[lane] = subStep * manifold.forces[at];
  }
  const ArmsOf<Block> arms(manifold, movers);
  const Vec3 tangent = manifold.normal.unitOrthogonal();
  const Vec3 tangents[] = {tangent, manifold.normal.cross(tangent)};
  fillPlane(manifold, arms, movers, tangents, lane, block);
  fillFriction(manifold, arms, movers, tangents, subStep, lane, block);
}

/// A lane that stands for nothing: its body never moves.
template <class Block>
void emptyLane(std::int32_t stillBody, int lane, Block& block) {
  block.manifolds[lane] = -1;
  block.plane.inertia.xx[lane] = block.plane.inertia.yy[lane] = block.plane.inertia.zz[lane] = 1;
  for (int k = 0; k < Block::kMovers; ++k) block.bodies[k][lane] = stillBody;
}

/// Puts a block's impulses into its manifolds, as forces.
template <class Block>
void storeForces(const Block& block, double subStep, std::vector<PersistentManifold>& manifolds) {
  const double rate = 1 / subStep;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (block.manifolds[lane] < 0) continue;
    PersistentManifold& manifold = manifolds[static_cast<std::size_t>(block.manifolds[lane])];
    for (int i = 0; i < Block::kPoints; ++i)
      manifold.forces[static_cast<std::size_t>(i)] = rate * block.points[i].impulse[lane];
    const auto& friction = block.friction;
    const auto tangent = [&](int i) {
      const LaneVector& t = friction.tangents[i];
      return Vec3(t.x[lane], t.y[lane], t.z[lane]);
    };
    manifold.frictionForce = rate * (friction.impulses[0][lane] * tangent(0) + friction.impulses[1][lane] * tangent(1));
    if constexpr (Block::kPoints > 1) manifold.twist = rate * block.twist.impulse[lane];
  }
}

}  // namespace cradle
