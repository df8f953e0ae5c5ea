#include "study/work_precision_chart.h"

#include <fmt/format.h>

#include "study/chart_panels.h"

namespace cradle {
namespace {

std::string headings(const WorkPrecisionChart& chart, const ChartLayout& layout) {
  const Reference& reference = chart.reference;
  const bool isTrusted = reference.uncertainty <= kTrustedUncertainty;
  std::string title = "Work and precision: " + chart.title;
  if (!isTrusted) title += fmt::format(" (THE REFERENCE IS UNCERTAIN BY {:.0e})", reference.uncertainty);
  const std::string subtitle = fmt::format("x: positions (m) and quaternions after {} s. Reference: {}; {}",
                                           chart.duration, reference.madeBy, reference.confirmation);
  return fmt::format(
      "set label 1 {} at screen 0.5, {} center font ',22' noenhanced textcolor rgb '{}'\n"
      "set label 2 {} at screen 0.5, {} center font ',14' noenhanced textcolor rgb '#505050'\n",
      quotedForGnuplot(title), layout.title, isTrusted ? "#000000" : "#c00000", quotedForGnuplot(subtitle),
      layout.subtitle);
}

std::string drawing(const WorkPrecisionChart& chart, const std::vector<Curve>& curves, const ChartLayout& layout) {
  return "set multiplot\nset logscale xy\nset format xy '10^{%T}'\nset border linecolor rgb '#404040'\n"
         "set grid xtics ytics linecolor rgb '#c8c8c8' linewidth 1 dashtype 1\nset tics nomirror\nset mxtics 10\n"
         "unset key\n" +
         headings(chart, layout) + errorPanels(curves, chart.reference.uncertainty, layout) +
         sidePanels(curves, layout) + legend(curves, layout) + "unset multiplot\n";
}

}  // namespace

std::string chartCommands(const WorkPrecisionChart& chart, ChartFormat format) {
  const std::vector<Curve> curves = curvesOf(chart.rows);
  const ChartLayout layout = layoutOf(curves);
  return dataBlocks(curves, chart.reference.uncertainty) +
         drawingCommands(drawing(chart, curves, layout), format, layout.height);
}

void drawChart(const WorkPrecisionChart& chart, const std::string& stem) {
  if (curvesOf(chart.rows).empty()) return;
  drawWithGnuplot(stem, [&](ChartFormat format) { return chartCommands(chart, format); });
}

}  // namespace cradle
