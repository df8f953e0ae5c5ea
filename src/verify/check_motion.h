#pragma once

#include "verify/truth_frame.h"

namespace cradle {

/// Where what is seen in a frame goes in the next one, and came from, by the poses of bodies and cameras; and whether
/// it is seen there, by the depths and ids of the next frame, if the folder has them (`next` is null if not), and by
/// the forms of bodies. How links move is not checked. O(pixels x bodies).
void checkMotion(const VerifiedFilm& film, const TruthFrame& frame, const TruthFrame* next, Findings& findings);

}  // namespace cradle
