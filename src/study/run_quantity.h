#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

enum class QuantityKind { energy, energyError, height, angle, phase, error };

/// A quantity of a run over its time, or, of `phase`, over another.
struct RunQuantity {
  QuantityKind kind = QuantityKind::energy;
  std::string name;  // of the body (height, angle, phase, error) or joint (angle, phase); empty: error of all bodies
};

/// Reads "energy,energyError,height:BODY,angle:NAME,phase:NAME,error,error:BODY", at least one of them, in any order. A
/// comma that is in one of `names`, of bodies and joints, is a part of that name. Throws Error(usage) for anything
/// else.
std::vector<RunQuantity> parseQuantities(const std::string& text, const std::vector<std::string>& names = {});

/// The names of a scene's bodies and joints that have commas.
std::vector<std::string> namesWithCommas(const Scene& scene);

/// A scene whose trajectory is asked for quantities. It must outlive this.
struct RunScene {
  std::string name;  // for the legend and messages
  const Scene& scene;
};

/// Throws Error(usage) unless runs of the scene have the quantity.
void requireQuantity(const RunQuantity& quantity, const RunScene& run);

/// A whole trajectory with its scene. Both must outlive it.
struct PlottedRun : RunScene {
  const TrajectoryReader& frames;
};

/// One line of a chart. Values are in SI units, and NaN where there is none.
struct QuantityCurve {
  std::string name;
  std::vector<double> x, y;
};

/// What a quantity is called on the axes of a chart.
struct QuantityAxes {
  std::string x, y;  // with units
  bool isLogarithmic = false;
};
QuantityAxes axesOf(const RunQuantity& quantity, const Scene& scene);

/// The curves of a run: of `energy`, if the run is shown `alone`, kinetic and potential beside the sum, the potential
/// from its lowest on. The angle of a joint is its coordinate; that of a body is the angle (rad, whole turns counted)
/// between gravity and the way from its pivot to its centre of mass, in the plane of both at the start, or of the
/// motion where the body hangs straight down then. The pivot is where the first of its joints, rods, ropes and springs
/// that goes to the world is held, else the first of all. `error` is the distance (m) from the same bodies of
/// `reference`, the greatest of all bodies if none is named; it may be null for other quantities. Throws as
/// requireQuantity does, and if the run has other frames than the reference.
std::vector<QuantityCurve> curvesOf(const RunQuantity& quantity, const PlottedRun& run, bool alone,
                                    const PlottedRun* reference);

}  // namespace cradle
