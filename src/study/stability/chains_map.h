#pragma once

#include "study/stability/maps.h"
#include "study/study_run.h"

namespace cradle {

/// What has become of a swinging chain after some seconds.
enum class ChainOutcome { holds, stretches, parts, stopped };

/// By the largest error of a rod (of 1 m) that the run showed.
ChainOutcome outcomeOf(const StudyRun& run);

/// The heaviest last ball (kg) with which RK4 is stable at a time step (s): step x frequency of the fastest swing
/// across the chain = 2.83, where it is pulled most, at the bottom of its way.
double heaviestForRk4(int balls, double timeStep);

/// Mass ratio against length of chains: where their rods hold.
StabilityMap chainsMap(const MapProgress& progress);

}  // namespace cradle
