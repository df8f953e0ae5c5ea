#pragma once

#include <string>
#include <vector>

#include "study/peers/peer_run.h"
#include "study/sample_scenes.h"

namespace cradle {

inline const Peer& peerNamed(const std::string& name) {
  return *methodOf(name).peer;
}

/// Frames at `framesPerSecond` of a scene in another engine.
inline std::vector<Frame> framesOf(Scene scene, const std::string& peer, double setting, double framesPerSecond) {
  scene.output.framesPerSecond = framesPerSecond;
  const Assembly assembly = assemble(scene, wholeScene(scene));
  std::vector<Frame> frames;
  runPeer(peerNamed(peer), setting, scene, assembly, [&](const Frame& frame) { frames.push_back(frame); });
  return frames;
}

inline std::string missingIn(const std::string& peer, const Scene& scene) {
  return peerNamed(peer).missingIn(scene, assemble(scene, wholeScene(scene)));
}

/// How far an engine's start is from the scene's: the largest difference of any component of the state.
inline double startError(const Scene& scene, const Peer& peer) {
  const Assembly assembly = assemble(scene, wholeScene(scene));
  VectorX state = assembly.state;
  peer.open(scene, assembly, 1e-3)->read(state);
  for (Eigen::Index body = 0; body < bodyCount(state); ++body)
    if (orientation(state, body).dot(orientation(assembly.state, body)) < 0)
      state.segment<4>(body * kPoseSize + 3) *= -1;
  return (state - assembly.state).cwiseAbs().maxCoeff();
}

}  // namespace cradle
