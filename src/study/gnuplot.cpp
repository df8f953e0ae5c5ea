#include "study/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/part_file.h"
#include "core/part_lock.h"
#include "core/printable.h"
#include "image/child_process.h"
#include "image/font.h"

namespace cradle {
namespace {

constexpr StartFailure kNoGnuplot{ErrorKind::output, "gnuplot-nox"};
constexpr std::size_t kLastBytes = 16;  // of a picture: its end is among them

/// What gnuplot makes of `commands`, which has the format's end among its last bytes: gnuplot says nothing of a full
/// disk. `path` is for messages alone: gnuplot prints the picture, and knows no file that it could overwrite.
std::string drawn(const std::string& commands, ChartFormat format, const std::string& path) {
  const std::string end = format == ChartFormat::svg ? "</svg>" : "IEND";
  ChildProcess gnuplot({"gnuplot"}, kNoGnuplot);
  const bool taken = gnuplot.write(commands.data(), commands.size());
  if (gnuplot.finish() != 0 || !taken)
    throw Error(ErrorKind::output, path, "gnuplot failed: " + gnuplot.standardError());
  const std::string picture = gnuplot.standardOutput();
  if (picture.find(end, picture.size() - std::min(picture.size(), kLastBytes)) == std::string::npos)
    throw Error(ErrorKind::output, path, "could not be written to its end; is the disk full?");
  return picture;
}

}  // namespace

bool canDrawCharts() {
  try {
    return ChildProcess({"gnuplot", "--version"}, kNoGnuplot).finish() == 0;
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    return false;
  }
}

std::string quotedForGnuplot(const std::string& text) {
  std::string result = "'";
  for (const char c : printableLine(text)) result += c == '\'' ? "''" : std::string(1, c);
  return result + "'";
}

FittedText fittedForGnuplot(const std::string& text, double fontSize, double width, double height) {
  constexpr double kMinFontSize = 6, kSmaller = 0.94, kLine = 1.3;  // the line in em
  double size = fontSize;
  const auto lines = [&] { return wrappedText(printableLine(text), {kChartEm * size, 0, 0}, width); };
  const auto isTooHigh = [&] { return static_cast<double>(lines().size()) * kLine * kChartEm * size > height; };
  while (size > kMinFontSize && lines().size() > 1 && isTooHigh()) size *= kSmaller;
  std::string quoted;
  for (const std::string& line : lines()) quoted += (quoted.empty() ? "" : ".\"\\n\".") + quotedForGnuplot(line);
  const double below = std::max(static_cast<double>(lines().size()) - 1, 0.0) * kLine * kChartEm * size;
  return {fmt::format("{} font ',{:.3g}'", quoted.empty() ? "''" : quoted, size), below};
}

std::string drawingCommands(const std::string& drawing, ChartFormat format, int height) {
  const bool isSvg = format == ChartFormat::svg;
  return fmt::format("set terminal {} size 1600,{} font 'DejaVu Sans,15'{}\nmarkerScale = {}\n",
                     isSvg ? "svg" : "pngcairo", height, isSvg ? " fontscale 1.3 background 'white'" : "",
                     isSvg ? 0.7 : 1) +
         drawing + "unset output\n";
}

void drawWithGnuplot(const std::string& path, ChartFormat format, const std::string& commands) {
  PartFile file(path);
  file.write(drawn(commands, format, path));
  file.complete();
}

void drawWithGnuplot(const std::string& stem, const std::function<std::string(ChartFormat)>& commands) {
  PartFile svg(stem + ".svg"), png(stem + ".png");
  svg.write(drawn(commands(ChartFormat::svg), ChartFormat::svg, stem + ".svg"));
  png.write(drawn(commands(ChartFormat::png), ChartFormat::png, stem + ".png"));
  svg.complete();
  png.complete();
}

void requireWritableChart(const std::string& stem) {
  const PartLock svg(stem + ".svg"), png(stem + ".png");
}

}  // namespace cradle
