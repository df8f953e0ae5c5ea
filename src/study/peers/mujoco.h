#pragma once

#include "study/peers/peer.h"

namespace cradle {

/// MuJoCo 2.2.2 in double precision: reduced coordinates along trees of joints, soft constraints by convex
/// optimisation.
///   rods              tendons whose length a soft constraint keeps
///   joints in loops   soft constraints as well
///   springs           tendons with stiffness and damping: it knows them within a step
///   restitution       the spring and the damper of a contact that bounce so, as stiff as the time step allows
///   friction          the dynamic one
///   driven bodies     free and very heavy, with the forces that their motion takes; they are placed after each step
///   constant motors   forces on the coordinates of their joints
std::vector<Peer> mujocoPeers();

}  // namespace cradle
