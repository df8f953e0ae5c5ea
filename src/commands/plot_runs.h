#pragma once

#include <string>
#include <vector>

#include "commands/simulate_scene.h"

namespace cradle {

struct PlotOptions {
  std::vector<std::string> quantities = {"energy"};  // each as parseQuantities() reads it
  std::string reference;                             // scene or trajectory; empty: none
  std::vector<std::string> methods;                  // that scenes are simulated with; empty: "plan"
  SceneOptions scene;                                // of scenes; its time step is that of methods that take one
};

/// `cradle plot RUN... -o FILE.svg|FILE.png`: quantities of trajectories, and of scenes that are simulated, over time
/// in one chart. A run that becomes unstable is shown as far as it went. Throws Error(usage) for what is none of them,
/// or does not have the quantity, and Error(output) if gnuplot is missing or the chart cannot be written.
void plotRuns(const std::vector<std::string>& runs, const std::string& output, const PlotOptions& options, bool quiet);

}  // namespace cradle
