#pragma once

#include <string>
#include <vector>

#include "study/gnuplot.h"
#include "study/run_quantity.h"

namespace cradle {

/// Curves of runs in one pair of axes.
struct RunPanel {
  QuantityAxes axes;
  std::vector<QuantityCurve> curves;
  std::vector<char> hasFailed = {};  // of each curve: whether its run became unstable
};

/// The panel of a quantity. Throws as curvesOf does.
RunPanel panelOf(const RunQuantity& quantity, const std::vector<PlottedRun>& runs, const PlottedRun* reference);

/// The commands that make gnuplot print the panels one above the other, with one legend: curves of one name look the
/// same in all. Curves of runs that failed end at a cross, and may leave their panel towards that end.
std::string runChartCommands(const std::string& title, const std::vector<RunPanel>& panels, ChartFormat format);

}  // namespace cradle
