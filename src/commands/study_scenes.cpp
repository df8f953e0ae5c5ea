#include "commands/study_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <filesystem>
#include <limits>
#include <set>

#include "commands/simulate_scene.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "study/study_table.h"
#include "study/work_precision_chart.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTableName = "study.csv";
constexpr const char* kChartPrefix = "work_precision_";
constexpr std::array<double, 3> kWantedErrors = {1e-3, 1e-6, 1e-9};  // whose cost is printed

/// A scene to study, named in the table as its file is.
struct NamedScene {
  NamedScene(std::string fileName, Scene loaded) : name(std::move(fileName)), scene(std::move(loaded)) {}

  std::string name;
  StudyScene scene;
};

bool isResultName(const std::string& name) {
  return name == kTableName || name == partPath(kTableName) || name.starts_with(kChartPrefix);
}

void loadScenes(const std::vector<std::string>& paths, std::deque<NamedScene>& scenes) {
  std::set<std::string> names;
  for (const std::string& path : paths) {
    const std::string name = fs::path(path).stem().string();
    if (!names.insert(name).second)
      throw Error(ErrorKind::usage, path, fmt::format("a second scene file named \"{}\"; rename one", name));
    scenes.emplace_back(name, loadSceneAndWarn(path, {}));
  }
}

/// The least CPU time (s per simulated second) that gave an error of at most `wanted`.
std::string cheapest(const std::vector<StudyRow>& rows, const StudyMethod& method, double wanted) {
  double least = std::numeric_limits<double>::infinity();
  for (const StudyRow& row : rows)
    if (row.method == method.name && row.status == RunStatus::ok && row.error <= wanted)
      least = std::min(least, row.cpuSecondsPerSimulatedSecond);
  return std::isfinite(least) ? fmt::format("{:.2e}", least) : "-";
}

void printFindings(const NamedScene& named, const Reference& reference, const std::vector<StudyMethod>& methods,
                   const std::vector<StudyRow>& rows) {
  fmt::print("{}: reference {}; {}\n", named.name, reference.madeBy, reference.confirmation);
  fmt::print("  {:<20}{:>12}   CPU s per simulated s for error <= {:.0e}{:>10.0e}{:>10.0e}\n", "", "least error",
             kWantedErrors[0], kWantedErrors[1], kWantedErrors[2]);
  for (const StudyMethod& method : methods) {
    double least = std::numeric_limits<double>::infinity();
    for (const StudyRow& row : rows)
      if (row.method == method.name && row.status == RunStatus::ok) least = std::min(least, row.error);
    fmt::print("  {:<20}{:>12}{:>42}{:>10}{:>10}\n", method.name, std::isfinite(least) ? fmt::format("{:.1e}", least) : "-",
               cheapest(rows, method, kWantedErrors[0]), cheapest(rows, method, kWantedErrors[1]),
               cheapest(rows, method, kWantedErrors[2]));
  }
  for (const StudyRow& row : rows)
    if (row.status == RunStatus::failed) fmt::print("  {} at {}: {}\n", row.method, row.setting, row.message);
}

/// Studies one scene; `turns` counts the methods and references that are done.
WorkPrecisionChart studyScene(NamedScene& named, const std::vector<StudyMethod>& methods, StudyTable& table,
                              long& turns, Progress& progress) {
  const auto tick = [&] { progress.update(turns); };
  WorkPrecisionChart chart{named.scene.name(), {}, findReference(named.scene, tick), named.scene.duration()};
  progress.update(++turns);
  for (const StudyMethod& method : methods) {
    sweep(named.scene, named.name, method, chart.reference, [&](const StudyRow& row) {
      table.append(row);
      chart.rows.push_back(row);
      tick();
    });
    progress.update(++turns);
  }
  progress.endLine();
  printFindings(named, chart.reference, methods, chart.rows);
  return chart;
}

}  // namespace

void studyScenes(const std::vector<std::string>& paths, const std::string& folder,
                 const std::vector<std::string>& methodNames, bool quiet) {
  const std::vector<StudyMethod> methods = studyMethodsNamed(methodNames);
  requireOwnFolder(folder, "result of a study", isResultName);
  std::deque<NamedScene> scenes;
  loadScenes(paths, scenes);
  const bool drawsCharts = canDrawCharts();
  if (!drawsCharts) fmt::print(stderr, "warning: gnuplot is missing: there will be a table, but no charts\n");

  makeFolder(folder);
  const std::string tablePath = (fs::path(folder) / kTableName).string();
  StudyTable table(tablePath);
  Progress progress("Studying", "methods", static_cast<long>(scenes.size() * (methods.size() + 1)), quiet);
  long turns = 0;
  try {
    for (NamedScene& named : scenes) {
      const WorkPrecisionChart chart = studyScene(named, methods, table, turns, progress);
      if (drawsCharts) drawChart(chart, (fs::path(folder) / (kChartPrefix + named.name)).string());
    }
  } catch (const Error& error) {
    throw Error(error.kind(), "", fmt::format("{}; the rows up to then are in {}", error.what(), partPath(tablePath)));
  }
  table.complete();
  if (!drawsCharts)
    throw Error(ErrorKind::output, folder,
                "has study.csv, but no charts: gnuplot cannot be started; install the package gnuplot-nox");
}

}  // namespace cradle
