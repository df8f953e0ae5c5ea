#include "study/work_precision_chart.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "core/error.h"
#include "core/output_path.h"
#include "image/child_process.h"
#include "study/chart_panels.h"

namespace cradle {
namespace {

constexpr StartFailure kNoGnuplot{ErrorKind::output, "gnuplot-nox"};

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
      quoted(title), layout.title, isTrusted ? "#000000" : "#c00000", quoted(subtitle), layout.subtitle);
}

std::string drawing(const WorkPrecisionChart& chart, const std::vector<Curve>& curves, const ChartLayout& layout) {
  return "set multiplot\nset logscale xy\nset format xy '10^{%T}'\nset border linecolor rgb '#404040'\n"
         "set grid xtics ytics linecolor rgb '#c8c8c8' linewidth 1 dashtype 1\nset tics nomirror\nset mxtics 10\n"
         "unset key\n" +
         headings(chart, layout) + errorPanels(curves, chart.reference.uncertainty, layout) +
         sidePanels(curves, layout) + legend(curves, layout) + "unset multiplot\nunset output\n";
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
  const ChartLayout layout = layoutOf(curves);
  const std::string size = fmt::format("size {},{} font 'DejaVu Sans,15'", layout.width, layout.height);
  const std::string commands = drawing(chart, curves, layout);
  return dataBlocks(curves, chart.reference.uncertainty) +
         fmt::format("set terminal svg {} fontscale 1.3 background 'white'\nmarkerScale = 0.7\nset output {}\n", size,
                     quoted(svgPath)) +
         commands + "reset\n" +
         fmt::format("set terminal pngcairo {}\nmarkerScale = 1\nset output {}\n", size, quoted(pngPath)) + commands;
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
