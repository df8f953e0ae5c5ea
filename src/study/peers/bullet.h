#pragma once

#include "study/peers/peer.h"

namespace cradle {

/// Bullet 3.24: a btDiscreteDynamicsWorld in double precision that never puts bodies to sleep.
///   restitution and friction  as the scene's pairs of materials have them; Bullet knows one friction: the dynamic one
///   rods                      a row for its solver that keeps a distance, for want of a joint of its own
///   springs                   forces that are set before each step, from where the bodies are then
///   constant motors           impulses before each step: its friction does not see torques within one
///   other motors              its joints' own
///   driven bodies             kinematic, placed after each step, with the velocities that take them there
std::vector<Peer> bulletPeers();

}  // namespace cradle
