#pragma once

#include "study/peers/peer.h"

namespace cradle {

/// ODE 0.16.2, the Open Dynamics Engine, in double precision: semi-implicit Euler whose constraints a linear
/// complementarity problem solves once a step, exactly (dWorldStep) or by iterations (dWorldQuickStep).
///   restitution and friction  as the scene's pairs of materials have them; friction is a pyramid, and the dynamic one
///   rods                      its double ball joints
///   springs, constant motors  forces that are set before each step, from where the bodies are then
///   other motors              its joints' own
///   driven bodies             kinematic, placed after each step, with the velocities that take them there
std::vector<Peer> odePeers();

}  // namespace cradle
