#pragma once

#include "study/peers/peer.h"

namespace cradle {

/// Simbody 3.7 in double precision: reduced coordinates along trees of joints, the rest by constraint forces and
/// projection, integrators with error control. Driven bodies have prescribed coordinates. Contacts are missing:
/// Simbody's give way by a stiffness that scenes do not have.
std::vector<Peer> simbodyPeers();

}  // namespace cradle
