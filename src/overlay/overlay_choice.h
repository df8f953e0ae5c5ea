#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"

namespace cradle {

enum class PlotKind { energy, energyError, height };

/// What lies on the pictures of a film.
struct OverlayChoice {
  bool time = false;        // with the name of the scene
  bool contacts = false;    // impacts, with their impulses
  bool velocities = false;  // arrows of all dynamic bodies
  bool trails = false;      // of their centres of mass
  std::optional<PlotKind> plot;
  int plottedBody = 0;  // of PlotKind::height
};

/// Reads "time,contacts,velocities,trails,plot=WHAT", in any order and number, WHAT energy, energyError or height:BODY.
/// Throws Error(usage) for anything else, and for bodies that the scene has not or that do not move.
OverlayChoice parseOverlays(const std::string& text, const Scene& scene);

}  // namespace cradle
