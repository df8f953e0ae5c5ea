#include "study/work_precision_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>

#include "core/error.h"
#include "core/output_path.h"
#include "image/child_process.h"

namespace cradle {
namespace {

constexpr StartFailure kNoGnuplot{ErrorKind::output, "gnuplot-nox"};
constexpr double kTrusted = 1e-6;  // an uncertainty above it is told in red: the program's default accuracy

/// One colour (M. Okabe, K. Ito, "Color Universal Design", 2008: told apart by all eyes) and one marker a method.
struct Look {
  const char* color;
  int marker;  // gnuplot's pointtype
};
constexpr std::array<Look, 6> kLooks = {
    {{"#D55E00", 9}, {"#E69F00", 5}, {"#0072B2", 7}, {"#56B4E9", 13}, {"#009E73", 11}, {"#CC79A7", 15}}};

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
  for (std::size_t i = 0; i < studyMethods().size(); ++i) {
    curves.push_back(curveOf(studyMethods()[i], kLooks.at(i), rows));
    if (curves.back().points.empty()) curves.pop_back();
  }
  return curves;
}

double decadeBelow(double value) {
  return std::pow(10, std::floor(std::log10(value)));
}

/// From below the smallest error or uncertainty to a decade of room above the largest error, where blow-ups stand.
struct ErrorAxis {
  double bottom = 1e-1, top = 1;
};
ErrorAxis errorAxisOf(const std::vector<Curve>& curves, double uncertainty) {
  constexpr double kBottomMost = 1e-16, kTopMost = 1e4;
  ErrorAxis axis;
  const auto include = [&](double error) {
    axis.bottom = std::max(kBottomMost, std::min(axis.bottom, decadeBelow(error) / 10));
    axis.top = std::min(kTopMost, std::max(axis.top, 10 * decadeBelow(error)));
  };
  if (std::isfinite(uncertainty)) include(uncertainty);
  for (const Curve& curve : curves)
    for (const Point& point : curve.points) include(std::max(point.error, kBottomMost));
  axis.top *= 10;
  return axis;
}

/// A text for gnuplot, in quotes and without commands.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "''" : c == '\n' ? " " : std::string(1, c);
  return result + "'";
}

std::string dataBlocks(const std::vector<Curve>& curves, const ErrorAxis& axis) {
  std::string text;
  const auto addBlock = [&](const char* name, std::size_t curve, const std::vector<Point>& points, bool atTop) {
    text += fmt::format("${}{} << EOD\n", name, curve);
    for (const Point& point : points)
      text += fmt::format("{} {} {}\n", point.cpu, point.evaluations,
                          atTop ? axis.top / std::sqrt(10.0) : std::max(point.error, axis.bottom));
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
  const bool isTrusted = reference.uncertainty <= kTrusted;
  std::string second = fmt::format("Error after {} s against {}; {}", chart.duration, reference.madeBy,
                                   reference.confirmation);
  if (!isTrusted) second += ": THE REFERENCE IS NOT CERTAIN, smaller errors mean nothing";
  return fmt::format(
      "set label 1 {} at screen 0.5, 0.965 center font ',22' noenhanced\n"
      "set label 2 {} at screen 0.5, 0.918 center font ',14' noenhanced textcolor rgb '{}'\n",
      quoted("Work and precision: " + chart.title), quoted(second), isTrusted ? "#505050" : "#c00000");
}

std::string uncertaintyLine(const ErrorAxis& axis, double uncertainty) {
  if (!std::isfinite(uncertainty)) return "";
  return fmt::format(
      "set object 1 rectangle from graph 0, first {0} to graph 1, first {1} behind fillcolor rgb '#ececec' fillstyle "
      "solid noborder\n"
      "set arrow 1 from graph 0, first {1} to graph 1, first {1} nohead dashtype 2 linewidth 2 linecolor rgb '#606060'\n"
      "set label 3 'uncertainty of the reference' at graph 0.985, first {1} right offset 0, -0.8 font ',13' "
      "textcolor rgb '#606060'\n",
      axis.bottom, uncertainty);
}

std::string plotCommand(const std::vector<Curve>& curves, int column) {
  std::string text = "plot ";
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const Look& look = curves[i].look;
    text += fmt::format(
        "{}$curve{} using {}:3 with linespoints linewidth 2.5 pointtype {} pointsize 1.1 linecolor rgb '{}' notitle",
        i > 0 ? ", " : "", i, column, look.marker, look.color);
    if (!curves[i].blowUps.empty())
      text += fmt::format(", $blowUps{} using {}:3 with points pointtype 2 pointsize 1.6 linewidth 3 linecolor rgb '{}' "
                          "notitle",
                          i, column, look.color);
  }
  return text + "\n";
}

std::string legend(const std::vector<Curve>& curves) {
  std::string text =
      "unset label\nunset arrow\nunset object\nunset border\nunset tics\nunset xlabel\nunset ylabel\nunset grid\n"
      "unset logscale\nset key center center horizontal maxrows 1 samplen 3 width 2 noenhanced font ',15'\n"
      "set lmargin at screen 0.05\nset rmargin at screen 0.95\nset bmargin at screen 0.01\nset tmargin at screen 0.09\n"
      "plot [0:1][0:1] ";
  for (const Curve& curve : curves)
    text += fmt::format(
        "NaN with linespoints linewidth 2.5 pointtype {} pointsize 1.3 linecolor rgb '{}' title '{}', ",
        curve.look.marker, curve.look.color, quoted(curve.title).substr(1, quoted(curve.title).size() - 2));
  return text + "NaN with points pointtype 2 pointsize 1.6 linewidth 3 linecolor rgb '#404040' title 'unstable'\n";
}

std::string panels(const WorkPrecisionChart& chart, const std::vector<Curve>& curves, const ErrorAxis& axis) {
  std::string text = fmt::format(
      "set multiplot\nset logscale xy\nset format xy '10^{{%T}}'\nset border linecolor rgb '#404040'\n"
      "set grid xtics ytics linecolor rgb '#d8d8d8' linewidth 1 dashtype 1\nset tics nomirror\nset mxtics 10\n"
      "unset key\nset yrange [{}:{}]\nset bmargin at screen 0.2\nset tmargin at screen 0.88\n",
      axis.bottom, axis.top);
  text += headings(chart) + uncertaintyLine(axis, chart.reference.uncertainty);
  text +=
      "set lmargin at screen 0.075\nset rmargin at screen 0.495\n"
      "set ylabel 'error at the end:  max |x - x_{ref}| / (1 + |x_{ref}|),  x in m'\n"
      "set xlabel 'CPU time per simulated second (s)'\n" +
      plotCommand(curves, 1);
  text +=
      "unset label 1\nunset label 2\nset lmargin at screen 0.565\nset rmargin at screen 0.985\nunset ylabel\n"
      "set xlabel 'evaluations of the right-hand side, whole run'\n" +
      plotCommand(curves, 2);
  return text + legend(curves) + "unset multiplot\nunset output\n";
}

void finishFile(const std::string& path) {
  if (std::rename(partPath(path).c_str(), path.c_str()) != 0)
    throw Error(ErrorKind::output, path, std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace

bool canDrawCharts() {
  try {
    return ChildProcess({"gnuplot", "--version"}, kNoGnuplot).finish() == 0;
  } catch (const Error&) {
    return false;
  }
}

std::string chartCommands(const WorkPrecisionChart& chart, const std::string& svgPath, const std::string& pngPath) {
  const std::vector<Curve> curves = curvesOf(chart.rows);
  const ErrorAxis axis = errorAxisOf(curves, chart.reference.uncertainty);
  const std::string drawing = panels(chart, curves, axis);
  return dataBlocks(curves, axis) +
         fmt::format("set terminal svg size 1600,900 font 'DejaVu Sans,15' background 'white'\nset output {}\n",
                     quoted(svgPath)) +
         drawing + "reset\n" +
         fmt::format("set terminal pngcairo size 1600,900 font 'DejaVu Sans,15'\nset output {}\n", quoted(pngPath)) +
         drawing;
}

void drawChart(const WorkPrecisionChart& chart, const std::string& stem) {
  if (curvesOf(chart.rows).empty()) return;
  const std::string svg = stem + ".svg", png = stem + ".png";
  for (const std::string& path : {svg, png}) {
    requireWritableFile(path);
    requireWritableFile(partPath(path));
  }
  const std::string commands = chartCommands(chart, partPath(svg), partPath(png));
  ChildProcess gnuplot({"gnuplot"}, kNoGnuplot);
  const bool taken = gnuplot.write(commands.data(), commands.size());
  if (gnuplot.finish() != 0 || !taken)
    throw Error(ErrorKind::output, png, "gnuplot failed: " + gnuplot.standardError());
  finishFile(svg);
  finishFile(png);
}

}  // namespace cradle
