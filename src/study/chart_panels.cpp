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
constexpr int kLegendRow = 26;              // pixels

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

/// Places of methods in the legend: a column an engine, or of one engine columns of two rows.
std::vector<std::pair<int, int>> legendPlaces(const std::vector<Curve>& curves) {
  const bool isOneEngine = curves.front().engine == curves.back().engine;
  const int rows = isOneEngine ? 2 : static_cast<int>(curves.size());  // in a column, at the most
  std::vector<std::pair<int, int>> places;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const bool isNext = i == 0 || places.back().second + 1 == rows || curves[i].engine != curves[i - 1].engine;
    const int column = i == 0 ? 0 : places.back().first + (isNext ? 1 : 0);
    places.emplace_back(column, isNext ? 0 : places.back().second + 1);
  }
  return places;
}

int legendRows(const std::vector<Curve>& curves) {
  int rows = 1;
  for (const auto& [column, row] : legendPlaces(curves)) rows = std::max(rows, row + 1);
  return rows;
}

/// Around all costs, with room at both ends.
std::pair<double, double> costRangeOf(const std::vector<Curve>& curves, double ChartPoint::*cost, bool withBlowUps) {
  constexpr double kRoom = 2, kMinSpanRatio = 150;  // an axis has two powers of ten at least
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const Curve& curve : curves)
    for (const std::vector<ChartPoint>* points : {&curve.points, &curve.blowUps})
      for (const ChartPoint& point : *points)
        if ((withBlowUps || points == &curve.points) && point.*cost > 0)
          least = std::min(least, point.*cost), most = std::max(most, point.*cost);
  if (!(least <= most)) return {0.1, 1};
  const double room = std::max(kRoom, std::sqrt(kMinSpanRatio * least / most));
  return {least / room, most * room};
}

std::string costRange(const std::vector<Curve>& curves, double ChartPoint::*cost, bool withBlowUps) {
  const auto [least, most] = costRangeOf(curves, cost, withBlowUps);
  return fmt::format("set xrange [{}:{}]\n", least, most);
}

/// Where the first panel's curves go, in parts of it.
std::vector<std::pair<double, double>> waysOf(const std::vector<Curve>& curves, const ErrorAxis& axis) {
  constexpr int kSamples = 24;  // of the line between two points
  const auto [least, most] = costRangeOf(curves, &ChartPoint::cpu, true);
  const auto placeOf = [&, low = least, high = most](const ChartPoint& point) {
    const double error = std::clamp(point.error, axis.decades.bottom, axis.decades.top);
    return std::pair(std::log(point.cpu / low) / std::log(high / low),
                     std::log(error / axis.decades.bottom) / std::log(axis.end / axis.decades.bottom));
  };
  std::vector<std::pair<double, double>> ways;
  for (const Curve& curve : curves)
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const auto from = placeOf(curve.points[i]), to = placeOf(curve.points[std::min(i + 1, curve.points.size() - 1)]);
      for (int k = 0; k <= kSamples; ++k) {
        const double share = static_cast<double>(k) / kSamples;
        ways.emplace_back(from.first + share * (to.first - from.first),
                          from.second + share * (to.second - from.second));
      }
    }
  return ways;
}

/// An arrow to where error and cost are small, above the uncertainty and where no curve goes; none if there is no such
/// place.
std::string betterArrow(const std::vector<Curve>& curves, const ErrorAxis& axis, double uncertainty) {
  constexpr double kWidth = 0.13, kHeight = 0.15;  // parts of the panel
  const double bottom = axis.decades.bottom;
  const double lowest = std::isfinite(uncertainty) ? std::max(uncertainty, bottom) : bottom;
  const double least = std::log(lowest / bottom) / std::log(axis.end / bottom) + 0.01;
  const auto ways = waysOf(curves, axis);
  for (const double height : {least, least + 0.15, least + 0.3, least + 0.45})
    for (const double left : {0.02, 0.2, 0.4}) {
      const bool isFree = std::none_of(ways.begin(), ways.end(), [&](const auto& way) {
        return way.first > left && way.first < left + kWidth && way.second > height && way.second < height + kHeight;
      });
      if (isFree && height + kHeight < 0.9)
        return fmt::format(
            "set label 5 'better' at graph {}, graph {} center font ',13' textcolor rgb '#606060'\n"
            "set arrow 5 from graph {}, graph {} to graph {}, graph {} linewidth 2 linecolor rgb '#909090'\n",
            left + 0.065, height + 0.12, left + 0.075, height + 0.09, left + 0.015, height + 0.03);
    }
  return "";
}

}  // namespace

ChartLayout layoutOf(const std::vector<Curve>& curves) {
  // In pixels from the bottom.
  const bool hasSides = !sidesOf(curves).empty();
  const int note = 24, legendTop = note + 36 + kLegendRow * (legendRows(curves) - 1), sidesBottom = legendTop + 100,
            sidesTop = sidesBottom + 225, errorsBottom = hasSides ? sidesTop + 118 : legendTop + 96,
            errorsTop = errorsBottom + 580, height = errorsTop + 112;
  const auto part = [&](int place) { return static_cast<double>(place) / height; };
  return {height,
          part(legendTop),
          hasSides ? part(sidesBottom) : 0,
          hasSides ? part(sidesTop) : 0,
          part(errorsBottom),
          part(errorsTop),
          part(note),
          part(errorsTop + 38),
          part(errorsTop + 78)};
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
         costRange(curves, &ChartPoint::cpu, true) + betterArrow(curves, axis, uncertainty) +
         plotCommand(curves, "1:3", true) +
         "unset label 1\nunset label 2\nunset label 5\nunset arrow 5\nset lmargin at screen 0.565\nset rmargin at "
         "screen 0.985\nunset ylabel\n"
         "set xlabel 'evaluations of the right-hand side, whole run'\n" +
         costRange(curves, &ChartPoint::evaluations, true) + plotCommand(curves, "2:3", true) +
         "unset label\nunset arrow\nunset object\n";
}

std::string sidePanels(const std::vector<Curve>& curves, const ChartLayout& layout) {
  constexpr double kLeft = 0.075, kRight = 0.985, kGap = 0.06;  // in parts of the screen
  std::string text = fmt::format(
      "set bmargin at screen {}\nset tmargin at screen {}\nset xlabel 'CPU time per simulated second (s)'\n",
      layout.sidesBottom, layout.sidesTop);
  const std::vector<Side> sides = sidesOf(curves);
  if (sides.empty()) return "";
  const double count = static_cast<double>(sides.size()), width = (kRight - kLeft - kGap * (count - 1)) / count;
  text += costRange(curves, &ChartPoint::cpu, false);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Decades decades = decadesOf(curves, sides[i]);
    const double left = kLeft + (width + kGap) * static_cast<double>(i);
    text += fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset yrange [{}:{}]\n{}set label 6 {} at graph 0, 1.06 "
        "font ',14'\n{}",
        left, left + width, decades.bottom, decades.top, decades.tics(kSideLabels), quotedForGnuplot(sides[i].title),
        plotCommand(curves, sides[i].columns, false));
  }
  return text + "unset label\n";
}

std::string legend(const std::vector<Curve>& curves, const ChartLayout& layout) {
  constexpr double kLeft = 0.04, kColumn = 0.192, kSample = 0.024;  // in parts of the screen
  // gnuplot's own key has columns as wide as it guesses a text to be, and other guesses for other terminals.
  std::string text = fmt::format(
      "unset border\nunset tics\nunset xlabel\nunset ylabel\nunset grid\nunset logscale\n"
      "set label 'One marker a run: from each to the next, the time step is halved, or the accuracy asked for ten "
      "times finer. Crosses blew up.' at screen 0.5, {} center font ',13' textcolor rgb '#505050'\n",
      layout.note);
  const std::vector<std::pair<int, int>> places = legendPlaces(curves);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const auto [column, row] = places[i];
    const double left = kLeft + kColumn * column,
                 height = layout.legendTop - static_cast<double>(kLegendRow * row) / layout.height;
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
