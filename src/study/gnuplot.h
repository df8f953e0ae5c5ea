#pragma once

#include <array>
#include <functional>
#include <string>

namespace cradle {

/// Colours told apart by all eyes (M. Okabe, K. Ito, "Color Universal Design", 2008), and filled markers (gnuplot's
/// pointtype) to go with them.
constexpr std::array<const char*, 6> kChartColors = {"#D55E00", "#E69F00", "#0072B2", "#56B4E9", "#009E73", "#CC79A7"};
constexpr std::array<int, 6> kChartMarkers = {9, 5, 7, 13, 11, 15};

/// Whether the program that draws charts (gnuplot) can be started.
bool canDrawCharts();

/// A text for gnuplot, in quotes and without commands.
std::string quotedForGnuplot(const std::string& text);

/// The files of a chart.
struct ChartFiles {
  std::string svg, png;
};

/// Commands for gnuplot that make the same `drawing` into both files, 1600 pixels wide; it may use markerScale, by
/// which the sizes of markers look the same in both.
std::string drawingCommands(const std::string& drawing, const ChartFiles& files, int height = 900);

/// Draws stem.svg and stem.png by the commands that it is given for such files. Throws Error(output) if gnuplot is
/// missing or fails, or the files are not whole.
void drawWithGnuplot(const std::string& stem, const std::function<std::string(const ChartFiles&)>& commands);

}  // namespace cradle
