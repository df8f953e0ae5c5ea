#pragma once

#include "verify/truth_frame.h"

namespace cradle {

/// What each pixel of a frame shows, as far as its files say so: depths and normals of bodies with closed forms, that
/// no such body is before what is seen, how much of the picture each covers, and that points in the frames of bodies
/// are those that are seen. O(pixels x bodies).
void checkSurfaces(const VerifiedFilm& film, const TruthFrame& frame, Findings& findings);

}  // namespace cradle
