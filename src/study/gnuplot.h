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

/// Pixels of a letter's em for each unit of a font's size, in pictures of drawingCommands().
constexpr double kChartEm = 4.0 / 3;

/// A text for gnuplot that has its place.
struct FittedText {
  std::string command;    // the text, quoted, and its font
  double belowFirst = 0;  // pixels, of the lines after the first one
};

/// Wraps a text and makes it smaller so that it is at most as wide and high as that (pixels).
FittedText fittedForGnuplot(const std::string& text, double fontSize, double width, double height);

enum class ChartFormat { svg, png };

/// Commands that make gnuplot print a `drawing` as a picture of that format, 1600 pixels wide; it may use markerScale,
/// by which the sizes of markers look the same in both formats.
std::string drawingCommands(const std::string& drawing, ChartFormat format, int height = 900);

/// Writes a picture of that format, whole or not at all, with what gnuplot prints by `commands`. Throws Error(output)
/// if gnuplot is missing or fails, or the picture is not whole.
void drawWithGnuplot(const std::string& path, ChartFormat format, const std::string& commands);

/// Writes stem.svg and stem.png, whole or not at all, with what gnuplot prints by the commands for each. Throws
/// Error(output) if gnuplot is missing or fails, or a picture is not whole.
void drawWithGnuplot(const std::string& stem, const std::function<std::string(ChartFormat)>& commands);

/// Throws Error(output) unless these files could be written now. An earlier part of theirs goes.
void requireWritableChart(const std::string& stem);

}  // namespace cradle
