#pragma once

#include <string>

#include "study/gnuplot.h"
#include "study/stability/stability_map.h"

namespace cradle {

/// The commands that make gnuplot print the map in a format: a panel beside the other, axes and legend shared.
std::string chartCommands(const StabilityMap& map, ChartFormat format);

/// Draws stem.svg and stem.png. Throws Error(output) if gnuplot is missing or fails.
void drawChart(const StabilityMap& map, const std::string& stem);

}  // namespace cradle
