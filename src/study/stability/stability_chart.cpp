#include "study/stability/stability_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "study/stability/cell_rectangles.h"

namespace cradle {
namespace {

constexpr double kWideSpan = 300;         // last to first value of a logarithmic axis: beyond, tics are powers of ten
constexpr double kVeryWideSpan = 1e8;     // not every power has a tic, and none has smaller ones
constexpr std::size_t kMaxLetters = 120;  // of the legend in a line

/// Around all curves, with room at both ends.
Range rangeOfCurves(const StabilityMap& map, const Axis& axis, double MapPoint::*coordinate, double room) {
  Range range;
  for (const MapPanel& panel : map.panels)
    for (const MapCurve& curve : panel.curves)
      for (const MapPoint& point : curve.points)
        if (!axis.quantity.isLogarithmic || point.*coordinate > 0) range.include(point.*coordinate);
  CRADLE_CHECK(range.first < range.last);
  if (axis.quantity.isLogarithmic) {
    const double factor = std::pow(range.last / range.first, room);
    return {range.first / factor, range.last * factor};
  }
  const double margin = room * (range.last - range.first);
  return {range.first - margin, range.last + margin};
}

Range rangeOf(const StabilityMap& map, const Axis& axis, double MapPoint::*coordinate, double room) {
  if (hasCells(map)) return {edgesOf(axis).front(), edgesOf(axis).back()};
  if (!axis.values.empty()) return {axis.values.front(), axis.values.back()};
  return rangeOfCurves(map, axis, coordinate, room);
}

/// A name with its look, once for all panels.
struct LegendEntry {
  std::string name;
  CurveKind kind;
  std::size_t number;  // among those of its kind
};

std::vector<LegendEntry> legendOf(const StabilityMap& map) {
  std::vector<LegendEntry> entries;
  std::array<std::size_t, 4> numbers = {};
  for (const MapPanel& panel : map.panels)
    for (const MapCurve& curve : panel.curves)
      if (std::none_of(entries.begin(), entries.end(),
                       [&](const LegendEntry& entry) { return entry.name == curve.name && entry.kind == curve.kind; }))
        entries.push_back({curve.name, curve.kind, numbers.at(static_cast<std::size_t>(curve.kind))++});
  return entries;
}

/// How gnuplot draws a curve; without the words that say what.
std::string styleOf(const LegendEntry& entry) {
  if (entry.kind == CurveKind::theory)
    return fmt::format("with lines linewidth 2.5 dashtype {} linecolor rgb '#000000'", entry.number % 4 + 1);
  if (entry.kind == CurveKind::measured)
    return fmt::format("with points pointtype {} pointsize 1.1*markerScale linewidth 2 linecolor rgb '#000000'",
                       std::array<int, 3>{6, 4, 8}.at(entry.number % 3));
  const std::size_t look = entry.number % kChartColors.size();
  if (entry.kind == CurveKind::dots)
    return fmt::format("with points pointtype 7 pointsize 0.35*markerScale linecolor rgb '{}'", kChartColors.at(look));
  return fmt::format(
      "with linespoints linewidth 2.5 dashtype {} pointtype {} pointsize 1.1*markerScale linecolor rgb '{}'",
      entry.number / kChartColors.size() + 1, kChartMarkers.at(look), kChartColors.at(look));
}

std::string dataBlocks(const StabilityMap& map, const ColorScale& scale) {
  std::string text;
  for (std::size_t i = 0; i < map.panels.size(); ++i) {
    const MapPanel& panel = map.panels[i];
    if (!panel.cells.empty()) text += fmt::format("$cells{} << EOD\n{}EOD\n", i, cellRectangles(map, panel, scale));
    for (std::size_t j = 0; j < panel.curves.size(); ++j) {
      text += fmt::format("$curve{}_{} << EOD\n", i, j);
      for (const MapPoint& point : panel.curves[j].points)
        text += std::isfinite(point.x) && std::isfinite(point.y) ? fmt::format("{} {}\n", point.x, point.y) : "\n";
      text += "EOD\n";
    }
  }
  return text;
}

std::string plotCommand(const StabilityMap& map, std::size_t number, const std::vector<LegendEntry>& legend) {
  const MapPanel& panel = map.panels[number];
  std::string text = "plot ";
  if (!panel.cells.empty())
    text += fmt::format(
        "$cells{} using (($1+$2)/2):(($3+$4)/2):1:2:3:4:5 with boxxyerror fillstyle solid noborder linecolor {} "
        "notitle, ",
        number, map.outcomes.empty() ? "palette" : "rgb variable");
  for (std::size_t j = 0; j < panel.curves.size(); ++j) {
    const MapCurve& curve = panel.curves[j];
    const auto entry = std::find_if(legend.begin(), legend.end(), [&](const LegendEntry& each) {
      return each.name == curve.name && each.kind == curve.kind;
    });
    if (curve.kind == CurveKind::theory && !panel.cells.empty())
      text += fmt::format("$curve{}_{} using 1:2 with lines linewidth 6 linecolor rgb '#ffffff' notitle, ", number, j);
    text += fmt::format("$curve{}_{} using 1:2 {} notitle, ", number, j, styleOf(*entry));
  }
  return text + "NaN notitle\n";
}

std::string axisCommands(const char* letter, const Axis& axis, const Range& range) {
  const bool isWide = axis.quantity.isLogarithmic && range.last / range.first > kWideSpan;
  const bool isVeryWide = isWide && range.last / range.first > kVeryWideSpan;
  return fmt::format("{3} logscale {0}\nset {0}range [{1}:{2}]\nset format {0} '{4}'\n{5} m{0}tics\n", letter,
                     range.first, range.last, axis.quantity.isLogarithmic ? "set" : "unset", isWide ? "10^{%T}" : "%g",
                     isVeryWide ? "unset" : "set");
}

std::string colorBox(const StabilityMap& map, const ColorScale& scale) {
  if (!map.outcomes.empty() || !hasCells(map)) return "unset colorbox\n";
  const bool isWide = map.cell.isLogarithmic && scale.range().last / scale.range().first > kWideSpan;
  return fmt::format(
      "set palette defined (0 '#2166ac', 1 '#a9d3ee', 2 '#f7f0c8', 3 '#f4a582', 4 '#b2182b')\n"
      "set colorbox user origin screen 0.925, screen 0.175 size screen 0.014, screen 0.675\n"
      "{} logscale cb\nset cbrange [{}:{}]\nset format cb '{}'\nset cblabel {} noenhanced\n",
      map.cell.isLogarithmic ? "set" : "unset", scale.range().first, scale.range().last, isWide ? "10^{%T}" : "%g",
      quotedForGnuplot(labelOf(map.cell)));
}

/// Where the panels stand, in parts of the picture.
struct Grid {
  explicit Grid(const StabilityMap& map)
      : columns(map.panels.size() == 4 ? 2 : std::min<std::size_t>(map.panels.size(), 3)),
        rows((map.panels.size() + columns - 1) / columns),
        right(map.outcomes.empty() && hasCells(map) ? 0.91 : 0.975) {}

  std::size_t columns, rows;
  double left = 0.075, right, bottom = 0.175, top = 0.85;

  std::string marginsOf(std::size_t panel) const {
    constexpr double kGapAcross = 0.05, kGapAlong = 0.1;
    const double width = (right - left + kGapAcross) / static_cast<double>(columns) - kGapAcross;
    const double height = (top - bottom + kGapAlong) / static_cast<double>(rows) - kGapAlong;
    const double x = left + static_cast<double>(panel % columns) * (width + kGapAcross);
    const double y = top - static_cast<double>(panel / columns) * (height + kGapAlong);
    return fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset tmargin at screen {}\nset bmargin at screen {}\n", x,
        x + width, y, y - height);
  }
  bool isLeftmost(std::size_t panel) const { return panel % columns == 0; }
  bool isLowest(std::size_t panel, std::size_t panels) const { return panel + columns >= panels; }
};

std::string panelCommands(const StabilityMap& map, const std::vector<LegendEntry>& legend) {
  const Grid grid(map);
  std::string text;
  for (std::size_t i = 0; i < map.panels.size(); ++i) {
    text += grid.marginsOf(i);
    text += fmt::format("set title {} noenhanced offset 0, -0.5\n", quotedForGnuplot(map.panels[i].title));
    text += fmt::format("set xlabel {} noenhanced\nset ylabel {} noenhanced\n",
                        quotedForGnuplot(grid.isLowest(i, map.panels.size()) ? labelOf(map.x.quantity) : ""),
                        quotedForGnuplot(grid.isLeftmost(i) ? labelOf(map.y.quantity) : ""));
    text += plotCommand(map, i, legend);
    text += "unset label\nunset colorbox\n";
  }
  return text;
}

std::string legendCommands(const StabilityMap& map, const std::vector<LegendEntry>& legend) {
  constexpr std::size_t kSampleLetters = 8;
  std::size_t letters = 0;
  std::string entries;
  const auto add = [&](const std::string& style, const std::string& name) {
    if (name.empty()) return;
    letters += name.size() + kSampleLetters;
    entries += fmt::format("NaN {} title {}, ", style, quotedForGnuplot(name));
  };
  if (hasCells(map))
    for (const Outcome& outcome : map.outcomes)
      add(fmt::format("with boxes fillstyle solid noborder fillcolor rgb '{}'", outcome.color), outcome.name);
  for (const LegendEntry& entry : legend) add(styleOf(entry), entry.name);
  if (entries.empty()) return "";
  return fmt::format(
      "unset border\nunset tics\nunset xlabel\nunset ylabel\nunset title\nunset grid\nunset logscale\n"
      "set key center center horizontal Left reverse maxrows {} samplen 2.5 width 1 noenhanced font ',14'\n"
      "set lmargin at screen 0.03\nset rmargin at screen 0.97\nset bmargin at screen 0.01\nset tmargin at screen 0.09\n"
      "plot [0:1][0:1] {}NaN notitle\n",
      letters / kMaxLetters + 1, entries);
}

}  // namespace

std::string chartCommands(const StabilityMap& map, ChartFormat format) {
  CRADLE_CHECK(!map.panels.empty());
  const std::vector<LegendEntry> legend = legendOf(map);
  const ColorScale scale(map);
  const std::string drawing =
      fmt::format(
          "set multiplot\nset clip two\nset border linecolor rgb '#404040'\nset tics nomirror front\nunset key\n"
          "set grid xtics ytics linecolor rgb '#c8c8c8' linewidth 1 dashtype 1\n"
          "set label 1 {} at screen 0.5, 0.965 center font ',22' noenhanced\n"
          "set label 2 {} at screen 0.5, 0.922 center font ',14' noenhanced textcolor rgb '#505050'\n",
          quotedForGnuplot(map.title), quotedForGnuplot(map.subtitle)) +
      axisCommands("x", map.x, rangeOf(map, map.x, &MapPoint::x, 0)) +
      axisCommands("y", map.y, rangeOf(map, map.y, &MapPoint::y, 0.05)) + colorBox(map, scale) +
      panelCommands(map, legend) + legendCommands(map, legend) + "unset multiplot\n";
  return dataBlocks(map, scale) + drawingCommands(drawing, format);
}

void drawChart(const StabilityMap& map, const std::string& stem) {
  drawWithGnuplot(stem, [&](ChartFormat format) { return chartCommands(map, format); });
}

}  // namespace cradle
