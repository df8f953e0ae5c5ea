#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"

namespace cradle {

enum class PlotKind { energy, energyError, height };

/// What lies on the pictures of a film.
struct OverlayChoice {
  bool time = false;        // with the name of the scene
  bool contacts = false;    // impacts with their impulses, lasting contacts with their forces
  bool velocities = false;  // arrows of all dynamic bodies
  bool trails = false;      // of their centres of mass
  std::optional<PlotKind> plot;
  std::string plottedBody;  // name, of PlotKind::height

  /// Whether the film has to be known to its end before its first picture: sizes go with its greatest speed, impulse or
  /// force.
  bool needsWholeFilm() const { return contacts || velocities || plot; }
};

/// Reads "time,contacts,velocities,trails,plot=WHAT", in any order and number, WHAT energy, energyError or height:BODY.
/// Throws Error(usage) for anything else.
OverlayChoice parseOverlays(const std::string& text);

/// The index of the body whose height is plotted. Throws Error(usage) if the scene has none that moves of that name.
int plottedBody(const OverlayChoice& choice, const Scene& scene);

}  // namespace cradle
