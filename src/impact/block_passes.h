#pragma once

#include <tuple>

#include "impact/block_normals.h"

// What a pass does to one contact block. E. Catto, "Solver2D" (box2d.org, 2024) names the passes: soft contacts that
// take out overlap a little at a time, relaxed by rigid ones without it, so that taking out overlap leaves no speed.
// Bodies of a block's lanes are different, so that lanes do not see each other.

namespace cradle {

/// The motions of a block's bodies, loaded from and stored to their places.
template <class Block>
struct MotionsOf {
  LaneMotion movers[Block::kMovers];

  MotionsOf(const Block& block, const std::vector<BodyMotion>& motions) {
    for (int k = 0; k < Block::kMovers; ++k)
      movers[k] = gather(motions[static_cast<std::size_t>(block.bodies[k][0])],
                         motions[static_cast<std::size_t>(block.bodies[k][1])]);
  }
  void store(const Block& block, std::vector<BodyMotion>& motions) const {
    for (int k = 0; k < Block::kMovers; ++k) {
      scatter<0>(movers[k], motions[static_cast<std::size_t>(block.bodies[k][0])]);
      if (block.manifolds[1] >= 0) scatter<1>(movers[k], motions[static_cast<std::size_t>(block.bodies[k][1])]);
    }
  }

  /// Along a row: of B as seen from A, or of the world as seen from A.
  Lanes along(const LaneVector& direction, const LaneVector (&turns)[Block::kMovers]) const {
    if constexpr (Block::kBothMove)
      return dot(direction, movers[1].linear - movers[0].linear) + dot(turns[1], movers[1].angular) -
             dot(turns[0], movers[0].angular);
    else
      return -(dot(direction, movers[0].linear) + dot(turns[0], movers[0].angular));
  }
  Lanes twist(const LaneVector (&turns)[Block::kMovers]) const {
    if constexpr (Block::kBothMove)
      return dot(turns[1], movers[1].angular) - dot(turns[0], movers[0].angular);
    else
      return -dot(turns[0], movers[0].angular);
  }

  /// Along the normal, over the contact plane.
  PlaneSpeeds apart(const Block& block) const {
    const Lanes middle = along(block.normal, block.plane.turns);
    if constexpr (Block::kPoints == 1)
      return {middle, same(0), same(0)};
    else
      return {middle, twist(block.plane.slopeTurns[0]), twist(block.plane.slopeTurns[1])};
  }

  /// An impulse along a row, on B and backwards on A.
  void push(const Block& block, Lanes impulse, const LaneVector& direction, const LaneVector (&turns)[Block::kMovers]) {
    movers[0].linear = movers[0].linear - (impulse * block.inverseMasses[0]) * direction;
    if constexpr (Block::kBothMove)
      movers[1].linear = movers[1].linear + (impulse * block.inverseMasses[1]) * direction;
    turn(impulse, turns);
  }
  void pushApart(const Block& block, const Lanes (&impulses)[Block::kPoints]) {
    Lanes sum = impulses[0];
    for (int i = 1; i < Block::kPoints; ++i) sum += impulses[i];
    push(block, sum, block.normal, block.plane.turns);
    if constexpr (Block::kPoints > 1) {
      Lanes alongU = impulses[0] * block.points[0].u, alongV = impulses[0] * block.points[0].v;
      for (int i = 1; i < Block::kPoints; ++i)
        alongU += impulses[i] * block.points[i].u, alongV += impulses[i] * block.points[i].v;
      turn(alongU, block.plane.slopeTurns[0]);
      turn(alongV, block.plane.slopeTurns[1]);
    }
  }
  void turn(Lanes impulse, const LaneVector (&turns)[Block::kMovers]) {
    movers[0].angular = movers[0].angular - impulse * turns[0];
    if constexpr (Block::kBothMove) movers[1].angular = movers[1].angular + impulse * turns[1];
  }
};

template <class Block>
void rubBlock(Block& block, MotionsOf<Block>& velocities) {
  Lanes pressing = same(0), moment = same(0);
  for (int i = 0; i < Block::kPoints; ++i) {
    pressing += block.points[i].impulse;
    if constexpr (Block::kPoints > 1) moment += block.points[i].impulse * block.twist.levers[i];
  }
  auto& friction = block.friction;
  const Lanes slip0 = velocities.along(friction.tangents[0], friction.turns[0]);
  const Lanes slip1 = velocities.along(friction.tangents[1], friction.turns[1]);
  const Lanes free0 = friction.impulses[0] - (friction.mass11 * slip0 + friction.mass12 * slip1);
  const Lanes free1 = friction.impulses[1] - (friction.mass12 * slip0 + friction.mass22 * slip1);
  const Lanes most = friction.coefficient * pressing;
  const Lanes size = squareRoot(larger(free0 * free0 + free1 * free1, same(1e-300)));
  const Lanes part = smaller(same(1), most / size);
  const Lanes held0 = part * free0, held1 = part * free1;
  velocities.push(block, held0 - friction.impulses[0], friction.tangents[0], friction.turns[0]);
  velocities.push(block, held1 - friction.impulses[1], friction.tangents[1], friction.turns[1]);
  friction.impulses[0] = held0, friction.impulses[1] = held1;

  if constexpr (Block::kPoints > 1) {
    auto& twist = block.twist;
    const Lanes limit = friction.coefficient * moment;
    const Lanes free = twist.impulse - twist.mass * velocities.twist(twist.turns);
    const Lanes held = larger(-limit, smaller(limit, free));
    velocities.turn(held - twist.impulse, twist.turns);
    twist.impulse = held;
  }
}

/// Gives the bodies the impulses of the step before.
template <class Block>
void warmBlock(Block& block, SolverMotions& motions) {
  MotionsOf<Block> velocities(block, motions.velocities);
  Lanes impulses[Block::kPoints];
  for (int i = 0; i < Block::kPoints; ++i) impulses[i] = block.points[i].impulse;
  velocities.pushApart(block, impulses);
  for (int i = 0; i < 2; ++i)
    velocities.push(block, block.friction.impulses[i], block.friction.tangents[i], block.friction.turns[i]);
  if constexpr (Block::kPoints > 1) velocities.turn(block.twist.impulse, block.twist.turns);
  velocities.store(block, motions.velocities);
}

template <class Block>
bool isPressed(const Block& block) {
  LaneMask pressed{};
  for (const auto& point : block.points) pressed |= point.impulse > same(0);
  return pressed[0] | pressed[1];
}

/// Lets what is pressed rub. What neither is nor was pressed leaves the bodies as they are.
template <class Block>
void rubAndStore(Block& block, bool wasPressed, MotionsOf<Block>& velocities, SolverMotions& motions) {
  auto& friction = block.friction;
  LaneMask rubs = (friction.impulses[0] != same(0)) | (friction.impulses[1] != same(0));
  if constexpr (Block::kPoints > 1) rubs |= block.twist.impulse != same(0);
  if (!wasPressed && !(rubs[0] | rubs[1]) && !isPressed(block)) return;
  rubBlock(block, velocities);
  velocities.store(block, motions.velocities);
}

/// Gives the bodies the impulses that obey the laws. Returns the speeds that follow.
template <class Block>
PlaneSpeeds press(Block& block, const PlaneSpeeds& speeds, const NormalLaws<Block::kPoints>& laws,
                  MotionsOf<Block>& velocities) {
  Lanes impulses[Block::kPoints];
  const PlaneSpeeds after = solveNormals(block, speeds, laws, impulses);
  for (int i = 0; i < Block::kPoints; ++i) {
    const Lanes held = impulses[i];
    impulses[i] = held - block.points[i].impulse;
    block.points[i].impulse = held;
  }
  velocities.pushApart(block, impulses);
  return after;
}

/// How an overlapping contact of `separation` (m) yields: the spring's oscillation in the sub-step with its damping,
/// and the speed (m/s) at which it is to open.
struct Yielding {
  Lanes stiffness;  // of the bodies' mass
  Lanes wanted;

  Yielding(const Softness& soft, Lanes separation, Lanes rate) {
    const Lanes overlap = larger(same(0), -separation) * same(soft.hardening);
    const Lanes turn = same(soft.turn) * (same(1) + overlap * (same(1) + overlap * (same(1) + overlap)));
    const Lanes damping = same(soft.damping) + turn;
    stiffness = turn * damping;
    wanted = larger(separation * rate * turn / damping, same(-soft.mostPush));
  }
};

/// The only point of a manifold gets an impulse.
template <class Block>
void pressSingle(Block& block, Lanes free, MotionsOf<Block>& velocities) {
  auto& point = block.points[0];
  const Lanes held = larger(same(0), free);
  velocities.push(block, held - point.impulse, block.normal, block.plane.turns);
  point.impulse = held;
}

template <class Block>
void softenNormals(Block& block, const Softness& soft, Lanes rate, const PlaneSpeeds& moved,
                   MotionsOf<Block>& velocities) {
  const Lanes none = same(0);
  const PlaneSpeeds speeds = velocities.apart(block);
  if constexpr (Block::kPoints == 1) {
    auto& point = block.points[0];
    const Lanes separation = point.separation + moved.middle;
    const auto apart = separation > none;
    const Yielding yielding(soft, separation, rate);
    const Lanes share = same(1) / (same(1) + yielding.stiffness);
    const Lanes wanted = apart ? separation * rate : yielding.wanted;
    const Lanes massScale = apart ? same(1) : yielding.stiffness * share;
    const Lanes impulseScale = apart ? none : share;
    pressSingle(block, point.impulse - point.mass * massScale * (speeds.middle + wanted) - impulseScale * point.impulse,
                velocities);
    point.slack = point.impulse > none ? none : larger(none, separation * rate + speeds.middle);
  } else {
    NormalLaws<Block::kPoints> laws;
    for (int i = 0; i < Block::kPoints; ++i) {
      auto& point = block.points[i];
      const Lanes separation = point.separation + moved.at(point.u, point.v);
      const auto apart = separation > none;
      const Yielding yielding(soft, separation, rate);
      laws.stiffness[i] = point.mass * (apart ? same(SoftParameters::kRigid) : yielding.stiffness);
      laws.offset[i] =
          (apart ? point.impulse : none) - laws.stiffness[i] * (apart ? separation * rate : yielding.wanted);
      point.slack = separation * rate;
    }
    const PlaneSpeeds after = press(block, speeds, laws, velocities);
    for (auto& point : block.points)
      point.slack = point.impulse > none ? none : larger(none, point.slack + after.at(point.u, point.v));
  }
}

/// Lets contacts that are apart close within the sub-step at most, and pushes overlapping ones apart gently.
template <class Block>
void softenBlock(Block& block, const Softness& soft, double subStep, SolverMotions& motions) {
  MotionsOf<Block> velocities(block, motions.velocities);
  const PlaneSpeeds moved = MotionsOf<Block>(block, motions.displacements).apart(block);
  const bool wasPressed = isPressed(block);
  softenNormals(block, soft, same(1 / subStep), moved, velocities);
  rubAndStore(block, wasPressed, velocities, motions);
}

/// Stops what closes, whatever the overlap, but lets contacts that are still apart close.
template <class Block>
void relaxBlock(Block& block, SolverMotions& motions) {
  MotionsOf<Block> velocities(block, motions.velocities);
  const PlaneSpeeds speeds = velocities.apart(block);
  const bool wasPressed = isPressed(block);
  if constexpr (Block::kPoints == 1) {
    const auto& point = block.points[0];
    pressSingle(block, point.impulse - point.mass * (speeds.middle + point.slack), velocities);
  } else {
    NormalLaws<Block::kPoints> laws;
    for (int i = 0; i < Block::kPoints; ++i) {
      const auto& point = block.points[i];
      laws.stiffness[i] = same(SoftParameters::kRigid) * point.mass;
      laws.offset[i] = point.impulse - laws.stiffness[i] * point.slack;
    }
    press(block, speeds, laws, velocities);
  }
  rubAndStore(block, wasPressed, velocities, motions);
  // A sub-step's impulses hold those of the one before, which it began with.
  for (auto& point : block.points) point.total += point.impulse;
  for (int i = 0; i < 2; ++i) block.friction.totals[i] += block.friction.impulses[i];
  if constexpr (Block::kPoints > 1) block.twist.total += block.twist.impulse;
}

/// Rebounds contacts that closed faster than `slowest` (m/s) and were pressed in this step, in its last sub-step or in
/// one before.
template <class Block>
void reboundBlock(Block& block, double slowest, SolverMotions& motions) {
  if (block.restitution[0] == 0 && block.restitution[1] == 0) return;
  MotionsOf<Block> velocities(block, motions.velocities);
  const PlaneSpeeds starts = MotionsOf<Block>(block, motions.starts).apart(block), speeds = velocities.apart(block);
  for (auto& point : block.points) point.total -= point.impulse;
  NormalLaws<Block::kPoints> laws;
  for (int i = 0; i < Block::kPoints; ++i) {
    const auto& point = block.points[i];
    const Lanes before = starts.at(point.u, point.v);
    const auto rebounds = (before < same(-slowest)) & (point.total + point.impulse > same(0));
    if constexpr (Block::kPoints == 1) {
      const Lanes free = point.impulse - point.mass * (speeds.middle + block.restitution * before);
      pressSingle(block, rebounds ? free : point.impulse, velocities);
    } else {
      laws.stiffness[i] = rebounds ? same(SoftParameters::kRigid) * point.mass : same(0);
      laws.offset[i] = point.impulse - laws.stiffness[i] * block.restitution * before;
    }
  }
  if constexpr (Block::kPoints > 1) press(block, speeds, laws, velocities);
  for (auto& point : block.points) point.total += point.impulse;
  velocities.store(block, motions.velocities);
}

/// Finds what a contact's impulses took: their sum works with the mean of the velocities before the step and now, for
/// rows stay as they are. What closed faster than `slowest` (m/s) is an impact, with its friction; so is the closing
/// that others still had.
template <class Block>
void weighBlock(Block& block, double slowest, const SolverMotions& motions) {
  const MotionsOf<Block> starts(block, motions.starts), ends(block, motions.velocities);
  const Lanes none = same(0), half = same(-0.5);
  Lanes pressed = none, rubbed = none, fastest = none;
  const PlaneSpeeds opening = starts.apart(block), opened = ends.apart(block);
  for (const auto& point : block.points) {
    const Lanes before = opening.at(point.u, point.v);
    pressed += half * point.total * (before + opened.at(point.u, point.v));
    fastest = larger(fastest, -before);
  }
  for (int i = 0; i < 2; ++i) {
    const auto& [direction, turns] = std::tie(block.friction.tangents[i], block.friction.turns[i]);
    rubbed += half * block.friction.totals[i] * (starts.along(direction, turns) + ends.along(direction, turns));
  }
  if constexpr (Block::kPoints > 1)
    rubbed += half * block.twist.total * (starts.twist(block.twist.turns) + ends.twist(block.twist.turns));
  const auto strikes = fastest > same(slowest);
  block.struck = pressed + (strikes ? rubbed : none);
  block.rubbed = strikes ? none : rubbed;
}

}  // namespace cradle
