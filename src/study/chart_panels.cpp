#include "study/chart_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "study/gnuplot.h"

namespace cradle {
namespace {

constexpr double kMin = 1e-17, kMax = 1e4;  // of axes: what is less or more stands on their edge
constexpr int kSideLabels = 5;              // of an axis, at the most

double decadeBelow(double value) {
  return std::pow(10, std::floor(std::log10(value)));
}

/// Decades around values, for an axis.
struct Decades {
  double bottom = std::numeric_limits<double>::infinity(), top = 0;

  void include(double value) {
    const double shown = std::clamp(value, kMin, kMax);
    bottom = std::max(kMin, std::min(bottom, decadeBelow(shown / 3)));
    top = std::max(top, 10 * decadeBelow(shown));
  }

  std::string tics(int mostLabels) const {
    const int decades = static_cast<int>(std::lround(std::log10(top / bottom)));
    const double factor = std::pow(10, (decades + mostLabels - 1) / mostLabels);
    double first = top;
    while (first / factor >= 0.99 * bottom) first /= factor;
    return fmt::format("set ytics {}, {}, {}\n", first, factor, 1.01 * top);
  }
};

/// Decades around all errors and the uncertainty; above them a strip for blow-ups, if there are any.
struct ErrorAxis {
  Decades decades;
  double end = 1;  // of the strip; the top without one
};
ErrorAxis errorAxisOf(const std::vector<Curve>& curves, double uncertainty) {
  constexpr double kStrip = 0.1;  // as part of the axis
  ErrorAxis axis{{1e-1, 1}, 1};
  bool hasBlowUps = false;
  // What made the reference has no error of its own, and would draw the axis down to nothing.
  const double least = std::isfinite(uncertainty) ? uncertainty / 10 : 0;
  if (std::isfinite(uncertainty)) axis.decades.include(uncertainty);
  for (const Curve& curve : curves) {
    for (const ChartPoint& point : curve.points) axis.decades.include(std::max(point.error, least));
    hasBlowUps = hasBlowUps || !curve.blowUps.empty();
  }
  const double top = axis.decades.top;
  axis.end = hasBlowUps ? top * std::pow(top / axis.decades.bottom, kStrip / (1 - kStrip)) : top;
  return axis;
}

/// Height of a method's blow-ups in the strip, so that those of others do not hide them.
double blowUpHeight(const ErrorAxis& axis, std::size_t curve, std::size_t curves) {
  const double part = 1 - (static_cast<double>(curve) + 0.5) / static_cast<double>(curves);
  return axis.decades.top * std::pow(axis.end / axis.decades.top, part);
}

std::string uncertaintyBand(const ErrorAxis& axis, double uncertainty) {
  if (!std::isfinite(uncertainty)) return "";
  return fmt::format(
      "set object 1 rectangle from graph 0, first {0} to graph 1, first {1} behind fillcolor rgb '#ececec' fillstyle "
      "solid noborder\n"
      "set arrow 1 from graph 0, first {1} to graph 1, first {1} nohead dashtype 2 linewidth 2 linecolor rgb "
      "'#606060'\n"
      "set label 3 'uncertainty of the reference' at graph 0.985, first {1} right offset 0, -0.8 font ',13' "
      "textcolor rgb '#606060'\n",
      axis.decades.bottom, uncertainty);
}

/// An arrow to where error and cost are small, above the uncertainty.
std::string betterArrow(const ErrorAxis& axis, double uncertainty) {
  const double bottom = axis.decades.bottom;
  const double lowest = std::isfinite(uncertainty) ? std::max(uncertainty, bottom) : bottom;
  const double height = std::log(lowest / bottom) / std::log(axis.end / bottom);  // part of the panel
  return fmt::format(
      "set label 5 'better' at graph 0.075, graph {} center font ',13' textcolor rgb '#606060'\n"
      "set arrow 5 from graph 0.09, graph {} to graph 0.03, graph {} linewidth 2 linecolor rgb '#909090'\n",
      height + 0.12, height + 0.1, height + 0.04);
}

std::string blowUpStrip(const ErrorAxis& axis) {
  const double top = axis.decades.top;
  if (axis.end == top) return "";
  return fmt::format(
      "set object 2 rectangle from graph 0, first {0} to graph 1, first {1} behind fillcolor rgb '#fbeeee' fillstyle "
      "solid noborder\n"
      "set arrow 2 from graph 0, first {0} to graph 1, first {0} nohead linewidth 1 linecolor rgb '#a0a0a0'\n"
      "set label 4 'unstable' at graph 0.985, first {2} right font ',13' textcolor rgb '#a03030'\n",
      top, axis.end, std::sqrt(top * axis.end));
}

/// `columns` of the blocks: "1:3".
std::string plotCommand(const std::vector<Curve>& curves, const std::string& columns, bool withBlowUps) {
  std::string text = "plot ";
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const CurveLook& look = curves[i].look;
    text += fmt::format(
        "{}$curve{} using {} with linespoints dashtype {} linewidth {} pointtype {} pointsize {}*markerScale "
        "linecolor rgb '{}' notitle",
        i > 0 ? ", " : "", i, columns, look.dash, look.lineWidth, look.marker, look.size, look.color);
    if (withBlowUps && !curves[i].blowUps.empty())
      text += fmt::format(
          ", $blowUps{} using {} with points pointtype 2 pointsize 1.6*markerScale linewidth 3 linecolor rgb '{}' "
          "notitle",
          i, columns, look.color);
  }
  return text + "\n";
}

/// A quantity that drifts.
struct Side {
  const char* title;
  double ChartPoint::*value;
  const char* columns;  // of the blocks
};
constexpr std::array<Side, 3> kSides = {
    {{"energy drift, of the greatest kinetic energy", &ChartPoint::energyDrift, "1:4"},
     {"constraint drift (m)", &ChartPoint::constraintDrift, "1:5"},
     {"deepest penetration (m)", &ChartPoint::penetration, "1:6"}}};

std::vector<Side> sidesOf(const std::vector<Curve>& curves) {
  std::vector<Side> sides;
  for (const Side& side : kSides)
    if (std::any_of(curves.begin(), curves.end(), [&](const Curve& curve) {
          return std::any_of(curve.points.begin(), curve.points.end(),
                             [&](const ChartPoint& point) { return point.*side.value > 0; });
        }))
      sides.push_back(side);
  return sides;
}

Decades decadesOf(const std::vector<Curve>& curves, const Side& side) {
  Decades decades;
  for (const Curve& curve : curves)
    for (const ChartPoint& point : curve.points)
      if (std::isfinite(point.*side.value)) decades.include(point.*side.value);
  return decades;
}

}  // namespace

ChartLayout layoutOf(const std::vector<Curve>& curves) {
  if (sidesOf(curves).empty()) return {960, 0.18, 0, 0, 0.28, 0.885, 0.022, 0.923, 0.965};
  return {1320, 0.139, 0.215, 0.385, 0.475, 0.915, 0.018, 0.944, 0.974};
}

std::string dataBlocks(const std::vector<Curve>& curves, double uncertainty) {
  const ErrorAxis axis = errorAxisOf(curves, uncertainty);
  const auto shown = [](double value) { return std::clamp(value, kMin, kMax); };  // NaN stays
  std::string text;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    text += fmt::format("$curve{} << EOD\n", i);
    for (const ChartPoint& point : curves[i].points)
      text += fmt::format("{} {} {} {} {} {}\n", point.cpu, point.evaluations,
                          std::clamp(point.error, axis.decades.bottom, axis.decades.top), shown(point.energyDrift),
                          shown(point.constraintDrift), shown(point.penetration));
    text += "EOD\n";
    if (curves[i].blowUps.empty()) continue;
    text += fmt::format("$blowUps{} << EOD\n", i);
    for (const ChartPoint& point : curves[i].blowUps)
      text += fmt::format("{} {} {}\n", point.cpu, point.evaluations, blowUpHeight(axis, i, curves.size()));
    text += "EOD\n";
  }
  return text;
}

std::string errorPanels(const std::vector<Curve>& curves, double uncertainty, const ChartLayout& layout) {
  constexpr int kMaxLabels = 8;
  const ErrorAxis axis = errorAxisOf(curves, uncertainty);
  return fmt::format("set yrange [{}:{}]\nset bmargin at screen {}\nset tmargin at screen {}\n", axis.decades.bottom,
                     axis.end, layout.errorsBottom, layout.errorsTop) +
         axis.decades.tics(kMaxLabels) + uncertaintyBand(axis, uncertainty) + blowUpStrip(axis) +
         "set lmargin at screen 0.075\nset rmargin at screen 0.495\n"
         "set ylabel 'error at the end:  max |x - x_{ref}| / (1 + |x_{ref}|)'\n"
         "set xlabel 'CPU time per simulated second (s)'\n" +
         betterArrow(axis, uncertainty) + plotCommand(curves, "1:3", true) +
         "unset label 1\nunset label 2\nunset label 5\nunset arrow 5\nset lmargin at screen 0.565\nset rmargin at "
         "screen 0.985\nunset ylabel\n"
         "set xlabel 'evaluations of the right-hand side, whole run'\n" +
         plotCommand(curves, "2:3", true) + "unset label\nunset arrow\nunset object\n";
}

std::string sidePanels(const std::vector<Curve>& curves, const ChartLayout& layout) {
  constexpr double kLeft = 0.075, kBetween = 0.315, kWidth = 0.255;  // in parts of the screen
  std::string text = fmt::format(
      "set bmargin at screen {}\nset tmargin at screen {}\nset xlabel 'CPU time per simulated second (s)'\n",
      layout.sidesBottom, layout.sidesTop);
  const std::vector<Side> sides = sidesOf(curves);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Decades decades = decadesOf(curves, sides[i]);
    const double left = kLeft + kBetween * static_cast<double>(i);
    text += fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset yrange [{}:{}]\n{}set label 6 {} at graph 0, 1.06 "
        "font ',14'\n{}",
        left, left + kWidth, decades.bottom, decades.top, decades.tics(kSideLabels), quotedForGnuplot(sides[i].title),
        plotCommand(curves, sides[i].columns, false));
  }
  return text + "unset label\n";
}

std::string legend(const std::vector<Curve>& curves, const ChartLayout& layout) {
  constexpr double kLeft = 0.04, kColumn = 0.192, kSample = 0.024, kRow = 0.02;  // in parts of the screen
  // gnuplot's own key has columns as wide as it guesses a text to be, and other guesses for other terminals.
  std::string text = fmt::format(
      "unset border\nunset tics\nunset xlabel\nunset ylabel\nunset grid\nunset logscale\n"
      "set label 'One marker a run: from each to the next, the time step is halved, or the accuracy asked for ten "
      "times finer. Crosses blew up.' at screen 0.5, {} center font ',13' textcolor rgb '#505050'\n",
      layout.note);
  const bool isOneEngine = curves.front().engine == curves.back().engine;
  const std::size_t rows = isOneEngine ? 2 : curves.size();  // in a column, at the most
  int column = -1;
  std::size_t row = 0;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const bool isNext = i == 0 || row + 1 == rows || curves[i].engine != curves[i - 1].engine;
    column += isNext ? 1 : 0;
    row = isNext ? 0 : row + 1;
    const double left = kLeft + kColumn * column, height = layout.legendTop - kRow * static_cast<double>(row);
    const CurveLook& look = curves[i].look;
    text += fmt::format(
        "set arrow from screen {0}, {2} to screen {1}, {2} nohead dashtype {3} linewidth {4} linecolor rgb '{5}'\n"
        "set label '' at screen {6}, {2} point pointtype {7} pointsize {8}*markerScale linecolor rgb '{5}'\n"
        "set label {9} at screen {10}, {2} left noenhanced font ',12'\n",
        left, left + kSample, height, look.dash, look.lineWidth, look.color, left + kSample / 2, look.marker, look.size,
        quotedForGnuplot(curves[i].title), left + kSample + 0.006);
  }
  return text +
         "set lmargin at screen 0.1\nset rmargin at screen 0.9\nset bmargin at screen 0.001\nset tmargin at "
         "screen 0.002\nplot [0:1][0:1] NaN notitle\n";
}

}  // namespace cradle
