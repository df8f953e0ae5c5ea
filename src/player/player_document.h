#pragma once

#include <functional>
#include <string>

#include "film/film_source.h"

namespace cradle {

/// What the player of a page (player/player.js) shows of a whole trajectory, as JSON without "<": bodies with shapes,
/// colours and patterns, links, states, energies, events and forces; and beside them the states of `other`, if it is
/// not null. `progress` is told the number of frames done. Throws Error(usage) if the
/// two have other bodies that move, or other times of frames; Error(limit) if there is more than a page holds; and what
/// reading throws.
std::string playerDocument(FilmSource& motion, const TrajectoryReader* other,
                           const std::function<void(long done)>& progress);

}  // namespace cradle
