#pragma once

#include <string>
#include <vector>

#include "study/gnuplot.h"
#include "study/work_precision.h"

namespace cradle {

/// Error against cost of all methods on one scene.
struct WorkPrecisionChart {
  std::string title;           // the scene
  std::vector<StudyRow> rows;  // of that scene
  Reference reference;
  double duration = 0;  // s
};

/// The commands that make gnuplot print the chart in a format. Blow-ups have no cost of their own: they
/// stand where a run of that step would, from the cost of the coarsest run that went well.
std::string chartCommands(const WorkPrecisionChart& chart, ChartFormat format);

/// Draws stem.svg and stem.png. Throws Error(output) if gnuplot is missing or fails.
void drawChart(const WorkPrecisionChart& chart, const std::string& stem);

}  // namespace cradle
