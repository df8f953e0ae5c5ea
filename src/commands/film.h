#pragma once

#include <string>
#include <vector>

#include "commands/pictures.h"

namespace cradle {

/// `cradle video SCENE|TRAJECTORY -o FILE.mp4`, with the scene's title card before it.
void makeFilm(const std::string& input, const std::string& film, const PictureOptions& options, bool quiet);

/// `cradle video --side-by-side A B ... -o FILE.mp4`: two to four scenes or trajectories with the same frames in a
/// second, each below its method. What becomes unstable, or is shorter, stands still at its end. Where the same bodies
/// are seen by a camera that no scene names, it is that of the run that stays the
/// smallest of the longest ones.
void makeSideBySideFilm(const std::vector<std::string>& inputs, const std::string& film, const PictureOptions& options,
                        bool quiet);

}  // namespace cradle
