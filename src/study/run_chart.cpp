#include "study/run_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/printable.h"
#include "image/font.h"

namespace cradle {
namespace {

constexpr int kPanelHeight = 560, kFrameHeight = 130;  // pixels
// Pixels that texts may take, beside axes and on the whole width.
constexpr double kBesidePanel = 460, kBesideAxis = 80, kBelowPanel = 1300, kBelowAxis = 30, kTitleWidth = 1500,
                 kTitleHeight = 50;
constexpr double kFontSize = 15, kTitleSize = 22, kMinLegendSize = 6;
constexpr int kRunLegendRow = 26, kUsualLegendRows = 2;  // pixels
// Pixels: gnuplot takes names to be narrower than they are, and a column to be as wide as it takes its names to be.
constexpr double kLegendWidth = 1300, kLegendSample = 100;
constexpr double kMargin = 0.05;        // of the values' range
constexpr double kShownOfFailed = 0.9;  // of a failed run, by time: growing without bound comes after

struct ValueRange {
  double low = INFINITY, high = -INFINITY;

  void include(double value) {
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  }
  bool isEmpty() const { return !(low <= high); }
};

/// Of all that is to be seen.
ValueRange valueRange(const RunPanel& panel) {
  ValueRange range;
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const std::vector<double>& values = panel.curves[i].y;
    const double shown = (panel.hasFailed[i] != 0 ? kShownOfFailed : 1) * static_cast<double>(values.size());
    for (std::size_t k = 0; k < values.size() && static_cast<double>(k) < shown; ++k) range.include(values[k]);
  }
  return range;
}

/// Around all curves: gnuplot would leave out what has no values, and fail where nothing has.
std::string abscissaCommands(const RunPanel& panel) {
  ValueRange range;
  for (const QuantityCurve& curve : panel.curves)
    for (const double x : curve.x) range.include(x);
  const bool isPhase = panel.axes.x != "time (s)";
  if (range.isEmpty() || !(range.low < range.high)) return "set xrange [0:1]\n";
  const double margin = isPhase ? kMargin * (range.high - range.low) : 0;
  return fmt::format("set xrange [{}:{}]\n", range.low - margin, range.high + margin);
}

std::string panelAxes(const RunPanel& panel) {
  std::string text = fmt::format("set xlabel {} noenhanced\nset ylabel {} noenhanced\n",
                                 fittedForGnuplot(panel.axes.x, kFontSize, kBelowPanel, kBelowAxis).command,
                                 fittedForGnuplot(panel.axes.y, kFontSize, kBesidePanel, kBesideAxis).command);
  const ValueRange range = valueRange(panel);
  text += abscissaCommands(panel);
  if (panel.axes.isLogarithmic)
    return text + "set logscale y\nset format y '10^{%T}'\nset yrange [*:*]\n" +
           (range.isEmpty() ? "set yrange [1e-17:1]\n" : "");
  text += "unset logscale y\nset format y '%g'\n";
  if (range.isEmpty()) return text + "set yrange [-1:1]\n";
  const double margin =
      range.high > range.low ? kMargin * (range.high - range.low) : std::max(1e-3, kMargin * std::abs(range.high));
  return text + fmt::format("set yrange [{}:{}]\n", range.low - margin, range.high + margin);
}

/// Names of all curves, in the order in which they first come.
std::vector<std::string> legendNames(const std::vector<RunPanel>& panels) {
  std::vector<std::string> names;
  for (const RunPanel& panel : panels)
    for (const QuantityCurve& curve : panel.curves)
      if (std::find(names.begin(), names.end(), curve.name) == names.end()) names.push_back(curve.name);
  return names;
}

/// How the names of a legend are laid out: in columns as wide as the widest.
struct Legend {
  double fontSize = kFontSize;
  int rows = kUsualLegendRows;
};

Legend legendOf(const std::vector<std::string>& names) {
  double widest = 0;  // of an em
  for (const std::string& name : names) widest = std::max(widest, textWidth(printableLine(name), {1, 0, 0}));
  const double room = kLegendWidth - kLegendSample;
  Legend legend;
  legend.fontSize = std::clamp(room / (widest * kChartEm), kMinLegendSize, kFontSize);
  const double columns =
      std::max(1.0, std::floor(kLegendWidth / (widest * kChartEm * legend.fontSize + kLegendSample)));
  legend.rows = std::max(kUsualLegendRows, static_cast<int>(std::ceil(static_cast<double>(names.size()) / columns)));
  return legend;
}

bool endsAtCross(const RunPanel& panel, std::size_t curve) {
  const std::vector<double>& values = panel.curves[curve].y;
  return panel.hasFailed[curve] != 0 && !values.empty() && std::isfinite(values.back());
}

std::string curveBlocks(const std::vector<RunPanel>& panels) {
  std::string text;
  for (std::size_t i = 0; i < panels.size(); ++i)
    for (std::size_t j = 0; j < panels[i].curves.size(); ++j) {
      const QuantityCurve& curve = panels[i].curves[j];
      text += fmt::format("$curve{}_{} << EOD\n", i, j);
      for (std::size_t k = 0; k < curve.x.size(); ++k)
        text += std::isfinite(curve.y[k]) ? fmt::format("{} {}\n", curve.x[k], curve.y[k]) : "\n";
      text += "EOD\n";
      if (endsAtCross(panels[i], j))
        text += fmt::format("$end{}_{} << EOD\n{} {}\nEOD\n", i, j, curve.x.back(), curve.y.back());
    }
  return text;
}

/// Curves of one name are one colour; after the last colour they begin again, dashed.
std::string lineStyle(std::size_t name) {
  return fmt::format("with lines linewidth 2.5 dashtype {} linecolor rgb '{}'", name / kChartColors.size() + 1,
                     kChartColors.at(name % kChartColors.size()));
}

bool hasValues(const QuantityCurve& curve) {
  return std::any_of(curve.y.begin(), curve.y.end(), [](double value) { return std::isfinite(value); });
}

std::string panelCommand(std::size_t number, const RunPanel& panel, const std::vector<std::string>& names,
                         bool hasLegend) {
  std::string text;
  for (std::size_t j = 0; j < panel.curves.size(); ++j) {
    if (!hasValues(panel.curves[j])) continue;
    const auto name = std::find(names.begin(), names.end(), panel.curves[j].name) - names.begin();
    text += fmt::format("{}$curve{}_{} using 1:2 {} notitle", text.empty() ? "plot " : ", ", number, j,
                        lineStyle(static_cast<std::size_t>(name)));
    if (endsAtCross(panel, j))
      text += fmt::format(
          ", $end{}_{} using 1:2 with points pointtype 2 pointsize 2*markerScale linewidth 3 linecolor "
          "rgb '{}' notitle",
          number, j, kChartColors.at(static_cast<std::size_t>(name) % kChartColors.size()));
  }
  if (text.empty()) text = "plot NaN notitle";  // errors may all be zero
  for (std::size_t i = 0; i < names.size() && hasLegend; ++i)
    text += fmt::format(", NaN {} title {} noenhanced", lineStyle(i), quotedForGnuplot(names[i]));
  return text + "\n";
}

}  // namespace

RunPanel panelOf(const RunQuantity& quantity, const std::vector<PlottedRun>& runs, const PlottedRun* reference) {
  RunPanel panel{axesOf(quantity, runs.front().scene), {}, {}};
  for (const PlottedRun& run : runs)
    for (QuantityCurve& curve : curvesOf(quantity, run, runs.size() == 1, reference)) {
      panel.curves.push_back(std::move(curve));
      panel.hasFailed.push_back(run.frames.hasFailed());
    }
  return panel;
}

std::string runChartCommands(const std::string& title, const std::vector<RunPanel>& panels, ChartFormat format) {
  const std::vector<std::string> names = legendNames(panels);
  const Legend legend = legendOf(names);
  const int below = 70 + kRunLegendRow * (legend.rows - kUsualLegendRows);
  const int height = kFrameHeight - 70 + below + kPanelHeight * static_cast<int>(panels.size());
  const double top = 1 - 60.0 / height,
               panelHeight = (top - static_cast<double>(below) / height) / static_cast<double>(panels.size());
  const FittedText shownTitle = fittedForGnuplot(title, kTitleSize, kTitleWidth, kTitleHeight);
  std::string text = fmt::format(
      "set multiplot\nset border linecolor rgb '#404040'\nset tics nomirror\n"
      "set grid xtics ytics linecolor rgb '#d0d0d0' linewidth 1 dashtype 1\n"
      "set label 1 {} at screen 0.5, {} center noenhanced\nset lmargin screen 0.125\nset rmargin screen "
      "0.97\n",
      shownTitle.command, 1 - (35 - shownTitle.belowFirst / 2) / height);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const bool isLast = i + 1 == panels.size();
    const double above = top - static_cast<double>(i) * panelHeight;
    text += fmt::format("set tmargin screen {}\nset bmargin screen {}\n", above, above - panelHeight + 75.0 / height);
    text += isLast && names.size() > 1 ? fmt::format(
                                             "set key at screen 0.53, {} center bottom horizontal Left "
                                             "reverse maxrows {} samplen 2 width 1 font ',{:.3g}'\n",
                                             8.0 / height, legend.rows, legend.fontSize)
                                       : "unset key\n";
    text += panelAxes(panels[i]) + panelCommand(i, panels[i], names, isLast && names.size() > 1) + "unset label 1\n";
  }
  return curveBlocks(panels) + drawingCommands(text + "unset multiplot\n", format, height);
}

}  // namespace cradle
