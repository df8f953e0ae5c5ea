#pragma once

#include "study/stability/maps.h"

namespace cradle {

/// What has become of a dropped stack of boxes after some seconds.
enum class StackOutcome { stands, leans, fallen, stopped };

/// Of the farthest (m) that any box is from where it should lie; NaN: the method stopped with an error.
StackOutcome outcomeOf(double farthest);

/// The farthest (m) by cradle's contact step, which RK4 with a fixed step takes, and by its fast one; a box of
/// `topMass` (kg) on boxes of 1 kg.
double farthestByContactStep(int boxes, double topMass);
double farthestByPile(int boxes, double topMass);

/// Mass ratio against height of stacks: where they stand.
StabilityMap stacksMap(const MapProgress& progress);

}  // namespace cradle
