#include "study/work_precision_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "study/gnuplot.h"

namespace cradle {
namespace {

/// A colour and a marker a method. The plan's open circles go around the markers of what it chose. Peers have a colour
/// an engine, open markers and dashed lines.
struct Look {
  const char* color;
  int marker;  // gnuplot's pointtype
  double size = 1.1, lineWidth = 2.5;
  int dash = 1;  // gnuplot's dashtype
};
constexpr Look kPlanLook = {kChartColors[5], 6, 2, 1.2};
constexpr std::array<const char*, 4> kEngineColors = {"#000000", "#7A5195", "#8C510A", "#7F7F7F"};
constexpr std::array<int, 4> kPeerMarkers = {4, 8, 6, 12};  // of an engine's methods
constexpr std::array<int, 4> kPeerDashes = {2, 4, 3, 5};
constexpr std::size_t kMostInALine = 6, kMostInThreeLines = 12;  // entries of the legend

std::vector<Look> looksOf(const std::vector<StudyMethod>& methods) {
  std::vector<Look> looks;
  std::size_t engine = 0, inEngine = 0;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const bool isNewEngine = i > 0 && methods[i].engine() != methods[i - 1].engine();
    if (isNewEngine && methods[i - 1].peer) ++engine;
    inEngine = isNewEngine ? 0 : inEngine + 1;
    if (methods[i].peer)
      looks.push_back({kEngineColors.at(engine), kPeerMarkers.at(inEngine), 1.2, 1.6, kPeerDashes.at(inEngine)});
    else
      looks.push_back(methods[i].method ? Look{kChartColors.at(i), kChartMarkers.at(i)} : kPlanLook);
  }
  return looks;
}

struct Point {
  double cpu, evaluations, error;
};

/// What one method shows.
struct Curve {
  std::string title;
  Look look;
  std::vector<Point> points, blowUps;
};

Curve curveOf(const StudyMethod& method, const Look& look, const std::vector<StudyRow>& rows) {
  Curve curve{method.title, look, {}, {}};
  std::vector<double> lostSteps;
  const StudyRow* coarsest = nullptr;
  for (const StudyRow& row : rows) {
    if (row.method != method.name) continue;
    if (row.status == RunStatus::unstable) lostSteps.push_back(row.setting);
    if (row.status != RunStatus::ok) continue;
    if (coarsest == nullptr) coarsest = &row;
    curve.points.push_back({row.cpuSecondsPerSimulatedSecond, row.evaluations, row.error});
  }
  for (const double step : lostSteps) {
    if (coarsest == nullptr) break;
    const double part = coarsest->setting / step;
    curve.blowUps.push_back({part * coarsest->cpuSecondsPerSimulatedSecond, part * coarsest->evaluations, 0});
  }
  return curve;
}

std::vector<Curve> curvesOf(const std::vector<StudyRow>& rows) {
  std::vector<Curve> curves;
  const std::vector<Look> looks = looksOf(studyMethods());
  for (std::size_t i = 0; i < looks.size(); ++i) {
    curves.push_back(curveOf(studyMethods()[i], looks[i], rows));
    if (curves.back().points.empty()) curves.pop_back();
  }
  return curves;
}

double decadeBelow(double value) {
  return std::pow(10, std::floor(std::log10(value)));
}

/// Decades around all errors and the uncertainty; above them a strip for blow-ups, if there are any.
struct ErrorAxis {
  double bottom = 1e-1, top = 1;
  double end = 1;  // of the strip; top without one
};
ErrorAxis errorAxisOf(const std::vector<Curve>& curves, double uncertainty) {
  constexpr double kBottomMost = 1e-17, kTopMost = 1e4, kStrip = 0.1;  // the strip as part of the axis
  ErrorAxis axis;
  bool hasBlowUps = false;
  const auto include = [&](double error) {
    axis.bottom = std::max(kBottomMost, std::min(axis.bottom, decadeBelow(error / 3)));
    axis.top = std::min(kTopMost, std::max(axis.top, 10 * decadeBelow(error)));
  };
  if (std::isfinite(uncertainty)) include(uncertainty);
  for (const Curve& curve : curves) {
    for (const Point& point : curve.points) include(std::max(point.error, kBottomMost));
    hasBlowUps = hasBlowUps || !curve.blowUps.empty();
  }
  axis.end = hasBlowUps ? axis.top * std::pow(axis.top / axis.bottom, kStrip / (1 - kStrip)) : axis.top;
  return axis;
}

/// Height of a method's blow-ups in the strip, so that those of others do not hide them.
double blowUpHeight(const ErrorAxis& axis, std::size_t curve, std::size_t curves) {
  const double part = 1 - (static_cast<double>(curve) + 0.5) / static_cast<double>(curves);
  return axis.top * std::pow(axis.end / axis.top, part);
}

std::string dataBlocks(const std::vector<Curve>& curves, const ErrorAxis& axis) {
  std::string text;
  const auto addBlock = [&](const char* name, std::size_t curve, const std::vector<Point>& points, bool areBlowUps) {
    text += fmt::format("${}{} << EOD\n", name, curve);
    for (const Point& point : points)
      text += fmt::format(
          "{} {} {}\n", point.cpu, point.evaluations,
          areBlowUps ? blowUpHeight(axis, curve, curves.size()) : std::clamp(point.error, axis.bottom, axis.top));
    text += "EOD\n";
  };
  for (std::size_t i = 0; i < curves.size(); ++i) {
    addBlock("curve", i, curves[i].points, false);
    if (!curves[i].blowUps.empty()) addBlock("blowUps", i, curves[i].blowUps, true);
  }
  return text;
}

std::string headings(const WorkPrecisionChart& chart) {
  const Reference& reference = chart.reference;
  const bool isTrusted = reference.uncertainty <= kTrustedUncertainty;
  std::string title = "Work and precision: " + chart.title;
  if (!isTrusted) title += fmt::format(" (THE REFERENCE IS UNCERTAIN BY {:.0e})", reference.uncertainty);
  const std::string subtitle = fmt::format("x: positions (m) and quaternions after {} s. Reference: {}; {}",
                                           chart.duration, reference.madeBy, reference.confirmation);
  return fmt::format(
      "set label 1 {} at screen 0.5, 0.965 center font ',22' noenhanced textcolor rgb '{}'\n"
      "set label 2 {} at screen 0.5, 0.918 center font ',14' noenhanced textcolor rgb '#505050'\n",
      quotedForGnuplot(title), isTrusted ? "#000000" : "#c00000", quotedForGnuplot(subtitle));
}

std::string uncertaintyLine(const ErrorAxis& axis, double uncertainty) {
  if (!std::isfinite(uncertainty)) return "";
  return fmt::format(
      "set object 1 rectangle from graph 0, first {0} to graph 1, first {1} behind fillcolor rgb '#ececec' fillstyle "
      "solid noborder\n"
      "set arrow 1 from graph 0, first {1} to graph 1, first {1} nohead dashtype 2 linewidth 2 linecolor rgb "
      "'#606060'\n"
      "set label 3 'uncertainty of the reference' at graph 0.985, first {1} right offset 0, -0.8 font ',13' "
      "textcolor rgb '#606060'\n",
      axis.bottom, uncertainty);
}

/// An arrow to where error and cost are small, above the uncertainty.
std::string betterArrow(const ErrorAxis& axis, double uncertainty) {
  const double lowest = std::isfinite(uncertainty) ? std::max(uncertainty, axis.bottom) : axis.bottom;
  const double height = std::log(lowest / axis.bottom) / std::log(axis.end / axis.bottom);  // part of the panel
  return fmt::format(
      "set label 5 'better' at graph 0.075, graph {} center font ',13' textcolor rgb '#606060'\n"
      "set arrow 5 from graph 0.09, graph {} to graph 0.03, graph {} linewidth 2 linecolor rgb '#909090'\n",
      height + 0.12, height + 0.1, height + 0.04);
}

std::string blowUpStrip(const ErrorAxis& axis) {
  if (axis.end == axis.top) return "";
  return fmt::format(
      "set object 2 rectangle from graph 0, first {0} to graph 1, first {1} behind fillcolor rgb '#fbeeee' fillstyle "
      "solid noborder\n"
      "set arrow 2 from graph 0, first {0} to graph 1, first {0} nohead linewidth 1 linecolor rgb '#a0a0a0'\n"
      "set label 4 'unstable' at graph 0.985, first {2} right font ',13' textcolor rgb '#a03030'\n",
      axis.top, axis.end, std::sqrt(axis.top * axis.end));
}

std::string errorTics(const ErrorAxis& axis) {
  constexpr double kMostDecades = 8;  // that are all labelled
  const double factor = axis.top / axis.bottom > std::pow(10, kMostDecades) ? 100 : 10;
  double first = axis.top;
  while (first / factor >= 0.99 * axis.bottom) first /= factor;
  return fmt::format("set ytics {}, {}, {}\n", first, factor, 1.01 * axis.top);
}

std::string plotCommand(const std::vector<Curve>& curves, int column) {
  std::string text = "plot ";
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const Look& look = curves[i].look;
    text += fmt::format(
        "{}$curve{} using {}:3 with linespoints dashtype {} linewidth {} pointtype {} pointsize {}*markerScale "
        "linecolor rgb '{}' notitle",
        i > 0 ? ", " : "", i, column, look.dash, look.lineWidth, look.marker, look.size, look.color);
    if (!curves[i].blowUps.empty())
      text += fmt::format(
          ", $blowUps{} using {}:3 with points pointtype 2 pointsize 1.6*markerScale linewidth 3 linecolor rgb '{}' "
          "notitle",
          i, column, look.color);
  }
  return text + "\n";
}

std::string legend(const std::vector<Curve>& curves) {
  const int lines = curves.size() <= kMostInALine ? 1 : curves.size() <= kMostInThreeLines ? 3 : 4;
  std::string text = fmt::format(
      "unset label\nunset arrow\nunset object\nunset border\nunset tics\nunset xlabel\nunset ylabel\nunset grid\n"
      "unset logscale\nset key center center horizontal Left reverse maxrows {} samplen 3 width 1 noenhanced font "
      "',{}'\n"
      "set lmargin at screen 0.03\nset rmargin at screen 0.97\nset bmargin at screen 0.05\nset tmargin at screen 0.1\n"
      "set label 1 'One marker a run: from each to the next, the time step is halved, or the accuracy asked for ten "
      "times finer.' at screen 0.5, 0.025 center font ',13' textcolor rgb '#505050'\n"
      "plot [0:1][0:1] ",
      lines,
      lines == 1   ? 15
      : lines == 3 ? 12
                   : 10);
  for (const Curve& curve : curves)
    text += fmt::format(
        "NaN with linespoints dashtype {} linewidth {} pointtype {} pointsize {}*markerScale linecolor rgb '{}' title "
        "{}, ",
        curve.look.dash, curve.look.lineWidth, curve.look.marker, curve.look.size, curve.look.color,
        quotedForGnuplot(curve.title));
  const bool hasBlowUps =
      std::any_of(curves.begin(), curves.end(), [](const Curve& curve) { return !curve.blowUps.empty(); });
  if (!hasBlowUps) return text + "NaN notitle\n";
  return text +
         "NaN with points pointtype 2 pointsize 1.6*markerScale linewidth 3 linecolor rgb '#404040' title 'blew up'\n";
}

std::string panels(const WorkPrecisionChart& chart, const std::vector<Curve>& curves, const ErrorAxis& axis) {
  std::string text = fmt::format(
      "set multiplot\nset logscale xy\nset format xy '10^{{%T}}'\nset border linecolor rgb '#404040'\n"
      "set grid xtics ytics linecolor rgb '#c8c8c8' linewidth 1 dashtype 1\nset tics nomirror\nset mxtics 10\n"
      "unset key\nset yrange [{}:{}]\nset bmargin at screen 0.21\nset tmargin at screen 0.88\n",
      axis.bottom, axis.end);
  text += headings(chart) + errorTics(axis) + uncertaintyLine(axis, chart.reference.uncertainty) + blowUpStrip(axis);
  text +=
      "set lmargin at screen 0.075\nset rmargin at screen 0.495\n"
      "set ylabel 'error at the end:  max |x - x_{ref}| / (1 + |x_{ref}|)'\n"

      "set xlabel 'CPU time per simulated second (s)'\n" +
      betterArrow(axis, chart.reference.uncertainty) + plotCommand(curves, 1);
  text +=
      "unset label 1\nunset label 2\nunset label 5\nunset arrow 5\nset lmargin at screen 0.565\nset rmargin at screen "
      "0.985\nunset ylabel\n"
      "set xlabel 'evaluations of the right-hand side, whole run'\n" +
      plotCommand(curves, 2);
  return text + legend(curves) + "unset multiplot\nunset output\n";
}

}  // namespace

std::string chartCommands(const WorkPrecisionChart& chart, const std::string& svgPath, const std::string& pngPath) {
  const std::vector<Curve> curves = curvesOf(chart.rows);
  const ErrorAxis axis = errorAxisOf(curves, chart.reference.uncertainty);
  const std::string drawing = panels(chart, curves, axis);
  return dataBlocks(curves, axis) + drawingCommands(drawing, {svgPath, pngPath});
}

void drawChart(const WorkPrecisionChart& chart, const std::string& stem) {
  if (curvesOf(chart.rows).empty()) return;
  drawWithGnuplot(stem, [&](const ChartFiles& files) { return chartCommands(chart, files.svg, files.png); });
}

}  // namespace cradle
