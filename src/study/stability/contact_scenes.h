#pragma once

#include <vector>

#include "collision/separation.h"
#include "simulate/assembly.h"

// Scenes in which contact decides, as small as they can be: bodies without friction, one thing to happen.

namespace cradle {

constexpr double kSceneGravity = 9.81;   // m/s^2, of all of them that have any
constexpr double kUsualStep = 1.0 / 60;  // s, of programs that step contact

/// A ball of 1 kg and radius 0.1 m, at rest, whose lowest point is `height` (m) above a plane. Gravity 9.81 m/s^2.
Scene bouncingBall(double restitution, double height, double duration);

constexpr double kMarbleRadius = 0.01;  // m

/// A marble on its way to a plate.
struct Throw {
  double gap = 0;    // m, between marble and plate at the start
  double speed = 0;  // m/s, straight at it
};

/// Marbles side by side, all on their way along +x to one plate of this thickness (m) at x = 0. No gravity, restitution
/// 1/2; the duration lets the slowest go twice as far as to the plate's other side.
Scene marblesAtPlate(double thickness, const std::vector<Throw>& throws);

/// Touching balls of radius 0.1 m and 1 kg on top of each other, on a plane; the topmost has `topMass` (kg).
Scene stackOfBalls(int balls, double topMass);

/// Cubes of 1 m and 1 kg that fall onto each other and a slab, each by 1 cm more than the one below; the topmost has
/// `topMass` (kg). Restitution 0, friction 0.5, 10 s.
Scene droppedStack(int boxes, double topMass);

/// Balls of radius 0.1 m and 1 kg, each hung by a rod of 1 m from the one above, the first from the world; the lowest
/// has `bobMass` (kg). Nothing touches.
Scene hangingChain(int balls, double bobMass);

/// The same chain in a straight line at 30 degrees from the vertical, at rest. 5 s.
Scene swingingChain(int balls, double bobMass);

/// Five touching balls of radius 0.05 m and 0.2 kg along x, without gravity and restitution 1: the first `moving` of
/// them go at 1 m/s at the others, which are at rest.
Scene rowOfFiveBalls(int moving);

/// The contacts of bodies that touch at the start, up to rounding, in the order of the bodies; leaves their pairs in
/// the assembly's geometry.
std::vector<Contact> contactsAtStart(Assembly& assembly);

}  // namespace cradle
