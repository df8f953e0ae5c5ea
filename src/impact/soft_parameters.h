#pragma once

namespace cradle {

/// The parameters of soft sub-stepping, for bodies of some 0.1 m and steps of 1/60 s, which are what it is used for.
///
/// Those without a formula were measured on heaps of 60 or 72 bodies of 0.2 m that fall into a tray: balls, layers of
/// cubes, turned cubes, capsules (those of soft_step_test), and turned cubes thrown down with 20 m/s. With all numbers
/// as they are these overlap by 1.0, 0.9, 2.2, 1.8 and 3.8 mm on the way, come to rest in 164, 47, 204, 147 and 129
/// steps, and layers of cubes regain 1.2 % of their kinetic energy. [a, b] is a window: with a or b in place of a
/// number, overlaps stay below 4 mm, no heap gains more than 1.5 % of its energy, and layers of cubes come to rest
/// within 60 steps. (Heaps are chaotic: times of others scatter by a third.) Behind it stands what goes wrong farther
/// out.
struct SoftParameters {
  // Scale.

  // They hold for bodies of this inner radius and more; for smaller ones in proportion (SoftScale). With 10 mm straight
  // towers of ten boxes of 20 mm lean by 5 mm, and with 5 mm those of 10 mm fall. More makes steps for boxes above 30
  // mm shorter, which stand without.
  static constexpr double kFullRadius = 15e-3;  // m
  // Thinner bodies count as this thick, for short steps are dear.
  static constexpr double kMinThickness = 1.0 / 64;  // of the bounding radius

  // Detections in a step.

  // Bodies that come nearer to each other between two detections get more of them. [5, 10] mm, at 1.3 times the cost
  // with 5; with 20 mm turned cubes overlap by 7 mm, with 40 mm by 23.
  static constexpr double kMaxApproach = 10e-3;  // m
  // But no more detections than these: up to 19 m/s that leaves kMaxApproach. [16, 128]; with 8, cubes of 20 m/s
  // overlap by 6 mm, and with 4 they fly apart.
  static constexpr int kMaxSubstepGroups = 32;  // a step
  // Contacts are known before bodies touch. [1.25, 10] mm; with 20 mm layers of cubes cost three times as much.
  static constexpr double kContactMargin = 5e-3;  // m
  // An impact turns bodies aside: this of the approach is added to the margin. [0.25, 1]; with 0, capsules overlap by
  // 2.8 mm, and with 2 layers of cubes come to rest in 74 steps.
  static constexpr double kDeflected = 0.5;  // of the approach
  // What counts of the approach of spheres, which have no edges that could be missed. [0.8, 1]; with 0.6 balls overlap
  // by 2.4 mm.
  static constexpr double kBallRatio = 0.8;
  // Of other bodies: those that approach more slowly may be pressed, and slip and tilt, and all of it counts. What is
  // faster meets where it was seen to, corners around that too, and this part of it counts. [0.75, 6] m/s, [0.5, 1];
  // with 0.4 m/s capsules come to no rest, and with 0.25 cubes of 20 m/s overlap by 5 mm.
  static constexpr double kPressed = 1.5;     // m/s
  static constexpr double kQuickRatio = 0.5;  // of what is faster
  // Of the speed of the farthest point, by rotation: few bodies touch with that one. [0.25, 1], at 1.3 times the cost
  // with 1.
  static constexpr double kSpinRatio = 0.5;

  // Sub-steps in a step.

  // At least. [6, 16]; with 4 balls regain 3.4 %, and layers of cubes come to rest in 96 steps.
  static constexpr int kSubSteps = 8;
  // While others than spheres move: with fewer, friction gives way little by little, and turned boxes creep for
  // seconds. [16, 32]; with 12 layers of cubes regain 1.8 %, with 8 4.2 %.
  static constexpr int kDisturbedSubSteps = 16;
  // Heaps with more spheres do without: they go on rolling for long whatever is done. [0, 1]: it decides how much is
  // spent for an earlier rest. Of 72 turned cubes and balls, a quarter of them balls, more sub-steps cost 1.4 times as
  // much in all, and rest comes in 256 steps in place of 438; half of them balls, 0.9 times as much, and in 186 in
  // place of 405.
  static constexpr double kManySpheres = 0.25;  // of all bodies
  // Approach in a sub-step, as far as an impact goes on into the next bodies. [0.85, 6.8] mm, at 1.4 times the cost
  // with 0.85, and with 1.7 mm of overlap between balls with 6.8; with 13.6 cubes of 20 m/s overlap by 4.5 mm.
  static constexpr double kMaxSubStepApproach = 3.4e-3;  // m

  // Contacts as springs.

  // By their number of points. 0.7 times as much lets layers of cubes regain 2.5 %, twice as much lets them tremble for
  // 126 steps; 1.4 times as much does neither.
  static constexpr double kFrequencies[] = {240, 170, 100, 100};  // Hz
  // Of critical damping. [2, 4]; with 1 layers of cubes regain 2.0 %, with 0.5 2.6 %, and with 8 cubes of 20 m/s
  // overlap by 4.6 mm.
  static constexpr double kDampingRatio = 2;
  // An overlap s raises the frequency 1 + x + x^2 + x^3 times, x = hardening s: four times at 3.3 mm. [300, 1200]; with
  // 150 cubes of 20 m/s overlap by 5 mm, and with 0 by 24.
  static constexpr double kHardening = 300;  // 1/m
  // Overlaps are taken out no faster: by 8 mm in a sub-step of 1/480 s, less than two margins. Cubes that begin 20 mm
  // in each other are thrown 1.5 m up all the same, 0.1 m with 1 m/s, and 5 m without a limit. Less leaves overlaps:
  // cubes of 20 m/s have 4.1 mm with 2 m/s, 4.3 with 1, and 9 with 0.5.
  static constexpr double kMaxPush = 4;  // m/s
  // Rigid contacts are taken as this much stiffer than the bodies are heavy, about the impulses so far (a proximal
  // step): four points on two rigid bodies have more impulses than the bodies have ways to move. [10, 100]; with 3
  // layers of cubes regain 1.6 %, with 1 2.4 %.
  static constexpr double kRigid = 10;
  // Newton's steps for the points of a manifold that press: more find hardly other points, as the next pass guesses
  // again. With 4 nothing is better; with 1 turned cubes regain 7 %.
  static constexpr int kNewtonSteps = 2;

  // Manifolds from step to step.

  // Two bodies may move so much against each other, or turn, both together, with one manifold. [0.1, 10] mm and [1e-3,
  // 0.1], at the same cost; turned cubes then regain up to 1 % in place of 0.01.
  static constexpr double kKeptMotion = 1e-3;  // m
  static constexpr double kKeptTurn = 0.01;    // rad
  // Points of two manifolds so near to each other are one, and its force goes on. [0.01, 1]
  static constexpr double kKeptPoint = 0.1;  // of the body's radius
  // Cosine between the normals of two manifolds, at least, for forces to go on. [0.5, 0.9]; with 0.99 capsules come to
  // no rest.
  static constexpr double kKeptNormal = 0.9;
  // Slower, static friction holds: gravity gives 0.16 m/s in a step. [0.1, 0.3] m/s; with 0.03 a cube nudged with
  // 0.05 m/s does not stop on a slope between both angles of friction, and with 1 one that slides with 0.5 m/s does.
  static constexpr double kSlowSliding = 0.1;  // m/s

  // Rest.

  // Slower than this is still: contacts at rest have as much. [0.125, 1], rest comes sooner with more; with 0.06 layers
  // of cubes come to rest in 80 steps.
  static constexpr double kStillRatio = 0.25;  // of the speed g h that gravity gives in a step
  // Still for so long is at rest. [0.125, 0.5] s; rest comes sooner or later by the difference.
  static constexpr double kStillTime = 0.5;  // s
};

}  // namespace cradle
