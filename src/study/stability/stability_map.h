#pragma once

#include <string>
#include <vector>

namespace cradle {

/// What an axis, or the colour of a cell, stands for.
struct Quantity {
  std::string name;  // "time step"
  std::string unit;  // "s"; empty: a ratio or a number of things
  bool isLogarithmic = false;
};

/// Values ascend: the centres of the cells. In a map of curves alone, the axis goes from the first to the last, or
/// around the curves if there are none.
struct Axis {
  Quantity quantity;
  std::vector<double> values;
};

Axis linearAxis(const std::string& name, const std::string& unit, const std::vector<double>& values);
Axis logarithmicAxis(const std::string& name, const std::string& unit, const std::vector<double>& values);

/// One of the things that can happen in a cell.
struct Outcome {
  std::string name;
  std::string color;  // "#rrggbb", light enough for curves to be seen on it
};

struct MapPoint {
  double x = 0, y = 0;
};

enum class CurveKind {
  theory,    // a boundary that theory has: a black line
  measured,  // a boundary found by bisection: black circles
  series,    // values against x: a line in a colour of its own, with a marker at each point
  dots       // points that no line joins, in a colour of their own
};

/// The same name means the same look in all panels, and one entry of the legend. A point that is not finite breaks the
/// line.
struct MapCurve {
  std::string name;
  CurveKind kind = CurveKind::series;
  std::vector<MapPoint> points;
};

/// One picture of a map, mostly of one method.
struct MapPanel {
  std::string title;
  /// cells[row * columns + column], row along y: a number as the outcomes count, or of the quantity that colours stand
  /// for; NaN: left white. Empty: curves alone.
  std::vector<double> cells;
  std::vector<MapCurve> curves;
};

/// Where methods hold and where they fail, over one or two quantities: NAME.csv, NAME.svg and NAME.png.
struct StabilityMap {
  std::string name;       // of its files
  std::string title;      // of its chart
  std::string subtitle;   // of its chart: what was run, in a line of at most 160 characters
  std::string paragraph;  // what is seen, and why
  Axis x, y;
  std::vector<Outcome> outcomes;  // of cells; none: cells are numbers
  Quantity cell;                  // what those numbers are
  std::vector<MapPanel> panels;   // 1..6
};

/// Outcomes of most maps, in this order.
enum class Stability { stable, inaccurate, unstable };
std::vector<Outcome> stabilityOutcomes();

/// `count` >= 2 values from first to last, in equal steps or in equal ratios.
std::vector<double> evenlySpaced(double first, double last, int count);
std::vector<double> logarithmicallySpaced(double first, double last, int count);

/// NAME.csv: lines "# title", "# subtitle" and "# paragraph", a header that names quantities and units, and a row for
/// each cell and each point of a curve:
///   panel  title of the panel
///   kind   cell, theory, measured, series or dots
///   name   of the outcome, or of the curve; empty for cells that are numbers
///   then x, y and, for cells that are numbers, the number
std::string tableOf(const StabilityMap& map);

/// "time step (s)".
std::string labelOf(const Quantity& quantity);

}  // namespace cradle
