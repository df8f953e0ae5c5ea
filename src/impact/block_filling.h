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

template <class Block>
void fillFriction(const ContactManifold& manifold, const Vec3 (&arms)[Block::kPoints][Block::kMovers],
                  const SolverBody* const (&bodies)[Block::kMovers], double subStep, int lane, Block& block) {
  Vec3 middle[Block::kMovers];
  for (int k = 0; k < Block::kMovers; ++k) {
    Vec3 sum = arms[0][k];
    for (int i = 1; i < Block::kPoints; ++i) sum += arms[i][k];
    middle[k] = sum / Block::kPoints;
  }

  auto& friction = block.friction;
  const Vec3 tangent1 = manifold.normal.unitOrthogonal(), tangent2 = manifold.normal.cross(tangent1);
  double inverse[2];
  for (int i = 0; i < 2; ++i) {
    const Vec3& tangent = i == 0 ? tangent1 : tangent2;
    setLane(friction.tangents[i], lane, tangent);
    inverse[i] = fillTurns<Block>(friction.turns[i], tangent, middle, bodies, lane);
    friction.totals[i][lane] = 0;
    friction.impulses[i][lane] = subStep * manifold.frictionForce.dot(tangent);
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
    for (int i = 0; i < Block::kPoints; ++i) block.twist.levers[i][lane] = (arms[i][0] - middle[0]).norm();
  }
}

/// Puts a manifold of the block's kind into one lane, with the impulses of its last forces in `subStep` (s).
template <class Block>
void fillLane(const ContactManifold& manifold, std::int32_t index, const std::vector<SolverBody>& bodies,
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
  block.restitution[lane] = manifold.law->restitution;
  Vec3 arms[Block::kPoints][Block::kMovers];
  for (int i = 0; i < Block::kPoints; ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    auto& point = block.points[i];
    arms[i][0] = movers[0]->worldFromBody * manifold.onA[at].template cast<double>();
    if constexpr (Block::kBothMove) arms[i][1] = movers[1]->worldFromBody * manifold.onB[at].template cast<double>();
    point.mass[lane] = 1 / fillTurns<Block>(point.turns, manifold.normal, arms[i], movers, lane);
    point.separation[lane] = manifold.separations[at];
    point.total[lane] = 0;
    point.impulse[lane] = subStep * manifold.forces[at];
  }
  fillFriction(manifold, arms, movers, subStep, lane, block);
}

/// A lane that stands for nothing: its body never moves.
template <class Block>
void emptyLane(std::int32_t stillBody, int lane, Block& block) {
  block.manifolds[lane] = -1;
  for (int k = 0; k < Block::kMovers; ++k) block.bodies[k][lane] = stillBody;
}

/// Puts a block's impulses into its manifolds, as forces.
template <class Block>
void storeForces(const Block& block, double subStep, std::vector<ContactManifold>& manifolds) {
  const double rate = 1 / subStep;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (block.manifolds[lane] < 0) continue;
    ContactManifold& manifold = manifolds[static_cast<std::size_t>(block.manifolds[lane])];
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
