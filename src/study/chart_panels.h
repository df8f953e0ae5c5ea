#pragma once

#include <string>
#include <vector>

#include "study/chart_curves.h"

namespace cradle {

/// Where the parts of a chart are, in parts of the screen from its bottom.
struct ChartLayout {
  int height = 0;  // pixels
  double legendTop = 0, sidesBottom = 0, sidesTop = 0, errorsBottom = 0, errorsTop = 0;
  double note = 0, subtitle = 0, title = 0;
};

/// With room for side panels if one of the curves has something to show there.
ChartLayout layoutOf(const std::vector<Curve>& curves);

/// The data of all panels, as blocks that their commands name. Errors beyond the axis stand on its edge.
std::string dataBlocks(const std::vector<Curve>& curves, double uncertainty);

/// Two panels: errors against CPU time and against evaluations; the band below the reference's uncertainty, and
/// blow-ups in a strip at the top.
std::string errorPanels(const std::vector<Curve>& curves, double uncertainty, const ChartLayout& layout);

/// Up to three panels: drift of energy and of constraints, and penetration against CPU time, those of them that the
/// scene has: a panel whose values are all zero or unknown is left out.
std::string sidePanels(const std::vector<Curve>& curves, const ChartLayout& layout);

/// Names and looks below all panels, a column an engine.
std::string legend(const std::vector<Curve>& curves, const ChartLayout& layout);

}  // namespace cradle
