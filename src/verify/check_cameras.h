#pragma once

#include "verify/truth_frame.h"

namespace cradle {

/// All cameras of a film: a picture's middle and square pixels, rotations, OpenCV's axes beside OpenGL's, frames and
/// times of the trajectory; and the camera that the scene names, if it stands still or only goes around its target.
void checkCameras(const VerifiedFilm& film, Findings& findings);

}  // namespace cradle
