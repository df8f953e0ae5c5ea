#include "study/peers/bullet.h"
#include "study/peers/mujoco.h"
#include "study/peers/ode.h"
#include "study/peers/peer.h"
#include "study/peers/simbody.h"

namespace cradle {

const std::vector<Peer>& peers() {
  static const std::vector<Peer> all = [] {
    std::vector<Peer> found;
    for (const auto& engine : {bulletPeers(), odePeers(), mujocoPeers(), simbodyPeers()})
      found.insert(found.end(), engine.begin(), engine.end());
    return found;
  }();
  return all;
}

}  // namespace cradle
