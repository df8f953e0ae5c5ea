#include "study/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "core/error.h"
#include "core/output_path.h"
#include "core/part_lock.h"
#include "image/child_process.h"

namespace cradle {
namespace {

constexpr StartFailure kNoGnuplot{ErrorKind::output, "gnuplot-nox"};
constexpr std::size_t kLastBytes = 16;  // of a file: its end is among them

/// Whether a file has its last bytes: gnuplot says nothing of a full disk.
bool endsWith(const std::string& path, const std::string& end) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return text.find(end, text.size() - std::min(text.size(), kLastBytes)) != std::string::npos;
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
  for (const char c : text) result += c == '\'' ? "''" : c == '\n' ? " " : std::string(1, c);
  return result + "'";
}

std::string drawingCommands(const std::string& drawing, const ChartFiles& files, int height) {
  const std::string size = fmt::format("size 1600,{} font 'DejaVu Sans,15'", height);
  return fmt::format("set terminal svg {} fontscale 1.3 background 'white'\nmarkerScale = 0.7\nset output {}\n", size,
                     quotedForGnuplot(files.svg)) +
         drawing + "reset\n" +
         fmt::format("set terminal pngcairo {}\nmarkerScale = 1\nset output {}\n", size, quotedForGnuplot(files.png)) +
         drawing;
}

void drawWithGnuplot(const std::string& stem, const std::function<std::string(const ChartFiles&)>& commands) {
  // Whole paths: gnuplot runs what stands behind a | in front.
  const std::string whole = std::filesystem::absolute(stem).string();
  const ChartFiles files{whole + ".svg", whole + ".png"};
  PartLock svg(files.svg), png(files.png);
  const std::string text = commands({partPath(files.svg), partPath(files.png)});
  ChildProcess gnuplot({"gnuplot"}, kNoGnuplot);
  const bool taken = gnuplot.write(text.data(), text.size());
  if (gnuplot.finish() != 0 || !taken)
    throw Error(ErrorKind::output, files.png, "gnuplot failed: " + gnuplot.standardError());
  for (const auto& [path, end] : {std::pair(files.svg, "</svg>"), std::pair(files.png, "IEND")})
    if (!endsWith(partPath(path), end))
      throw Error(ErrorKind::output, path, "could not be written to its end; is the disk full?");
  svg.finish();
  png.finish();
}

}  // namespace cradle
