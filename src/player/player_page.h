#pragma once

#include <functional>
#include <string_view>

#include "film/film_source.h"

namespace cradle {

/// Writes a page that needs nothing else and plays a whole trajectory in a browser; over it another one of the same
/// bodies, unless it is null. `progress` is told the number of frames done. Throws as playerDocument does.
void writePlayerPage(FilmSource& motion, const TrajectoryReader* other, const std::function<void(long done)>& progress,
                     const std::function<void(std::string_view)>& write);

}  // namespace cradle
