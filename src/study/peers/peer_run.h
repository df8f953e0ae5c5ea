#pragma once

#include <functional>

#include "study/peers/bullet.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Runs a scene in Bullet from its start to its end with a fixed time step (s), and hands on the frames of its output:
/// each with the state after the first step that reaches its time. `assembly` is the whole scene's. The cost is the CPU
/// time of the steps alone; evaluations are steps. Energies of frames know no dissipation. Throws Error(unstable) for
/// states that are not finite or have energy from nowhere (by the measure for our own methods, at frames), and whatever
/// `take` throws.
RunCost runBullet(const Scene& scene, const Assembly& assembly, const BulletSettings& settings, double timeStep,
                  const std::function<void(const Frame&)>& take);

/// Whether contacts or dampers may take energy, so that what is left of it says nothing about a method.
bool mayDissipate(const Assembly& assembly);

}  // namespace cradle
