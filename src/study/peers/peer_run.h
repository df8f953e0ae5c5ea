#pragma once

#include <functional>

#include "study/peers/peer.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Runs a scene in another engine from its start to its end, and hands on the frames of its output: each with the state
/// after the first step that reaches its time. `assembly` is the whole scene's; the scene must have nothing that the
/// engine misses. The cost is the CPU time of the steps alone. Energies of frames know no dissipation and no work.
/// Throws Error(unstable) for states that are not finite or have energy from nowhere (by the measure for our own
/// methods, at frames; where bodies are driven or joints have motors, all energy is taken for theirs), what the engine
/// gives up with, and whatever `take` throws.
RunCost runPeer(const Peer& peer, double setting, const Scene& scene, const Assembly& assembly,
                const std::function<void(const Frame&)>& take);

/// Whether contacts, dampers, driven bodies or motors may take or give energy, so that what is left of it says nothing
/// about a method.
bool mayChangeEnergy(const Assembly& assembly);

}  // namespace cradle
