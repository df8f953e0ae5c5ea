#include "commands/study_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "commands/simulate_scene.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "study/gnuplot.h"
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
  if (!(reference.uncertainty <= kTrustedUncertainty))
    fmt::print("  THE REFERENCE IS UNCERTAIN: errors below {:.1e} mean nothing\n", reference.uncertainty);
  fmt::print("  {:<20}{:>12}   CPU s a simulated s for error <= {:.0e}{:>12.0e}{:>12.0e}\n", "", "least error",
             kWantedErrors[0], kWantedErrors[1], kWantedErrors[2]);
  for (const StudyMethod& method : methods) {
    if (!named.scene.missingIn(method).empty()) continue;
    double least = std::numeric_limits<double>::infinity();
    for (const StudyRow& row : rows)
      if (row.method == method.name && row.status == RunStatus::ok) least = std::min(least, row.error);
    fmt::print("  {:<20}{:>12}{:>41}{:>12}{:>12}\n", method.name,
               std::isfinite(least) ? fmt::format("{:.1e}", least) : "-", cheapest(rows, method, kWantedErrors[0]),
               cheapest(rows, method, kWantedErrors[1]), cheapest(rows, method, kWantedErrors[2]));
  }
  std::map<std::string, std::string> missing;  // by engine
  for (const StudyMethod& method : methods)
    if (const std::string what = named.scene.missingIn(method); !what.empty()) missing[method.engine()] = what;
  for (const auto& [engine, what] : missing) fmt::print("  {} is left out: it does not have {}\n", engine, what);
  for (const StudyRow& row : rows)
    if (row.status == RunStatus::failed) fmt::print("  {} at {}: {}\n", row.method, row.setting, row.message);
}

/// How each of the other engines' methods is set up.
void printPeers(const std::vector<StudyMethod>& methods) {
  for (const StudyMethod& method : methods)
    if (method.peer)
      fmt::print("{:<20}{} {}: {}\n", method.name, method.peer->engine, method.peer->version,
                 method.peer->configuration);
}

/// A study of some scenes under way.
class Study {
 public:
  Study(std::string folder, std::vector<StudyMethod> methods, std::size_t scenes, bool quiet)
      : folder_(std::move(folder)),
        methods_(std::move(methods)),
        drawsCharts_(canDrawCharts()),
        table_((fs::path(folder_) / kTableName).string()),
        progress_("Studying", "methods", static_cast<long>(scenes * (methods_.size() + 1)), quiet) {
    if (peers().empty())
      fmt::print(stderr, "note: built without other engines (CMake: CRADLE_PEERS); only our own methods run\n");
    if (!drawsCharts_) fmt::print(stderr, "warning: gnuplot is missing: there will be a table, but no charts\n");
  }

  /// A scene without a reference, or a chart that cannot be drawn, is a fault to tell in the end: the rest is done.
  void add(NamedScene& named) {
    WorkPrecisionChart chart{named.scene.name(), {}, {}, named.scene.duration()};
    try {
      chart.reference = findReference(named.scene, [this] { progress_.update(turns_); });
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::limit) throw;
      note(error);
      turns_ += static_cast<long>(methods_.size()) + 1;
      return;
    }
    progress_.update(++turns_);
    for (const StudyMethod& method : methods_) sweepInto(chart, named, method);
    progress_.endLine();
    printFindings(named, chart.reference, methods_, chart.rows);
    draw(chart, named.name);
  }

  /// Throws the first fault.
  void finish() {
    table_.complete();
    if (fault_) throw Error(*fault_);
    if (!drawsCharts_)
      throw Error(ErrorKind::output, folder_,
                  "has study.csv, but no charts: gnuplot cannot be started; install the package gnuplot-nox");
  }

 private:
  void sweepInto(WorkPrecisionChart& chart, NamedScene& named, const StudyMethod& method) {
    sweep(named.scene, named.name, method, chart.reference, [&](const StudyRow& row) {
      table_.append(row);
      chart.rows.push_back(row);
      progress_.update(turns_);
    });
    progress_.update(++turns_);
  }

  void draw(const WorkPrecisionChart& chart, const std::string& name) {
    if (!drawsCharts_) return;
    try {
      drawChart(chart, (fs::path(folder_) / (kChartPrefix + name)).string());
    } catch (const Error& error) {
      note(error);
    }
  }

  void note(const Error& error) {
    progress_.endLine();
    fmt::print(stderr, "{}\n", error.what());
    if (!fault_) fault_ = error;
  }

  std::string folder_;
  std::vector<StudyMethod> methods_;
  bool drawsCharts_;
  StudyTable table_;
  Progress progress_;
  long turns_ = 0;  // methods and references that are done
  std::optional<Error> fault_;
};

}  // namespace

void studyScenes(const std::vector<std::string>& paths, const std::string& folder,
                 const std::vector<std::string>& methodNames, bool quiet) {
  const std::vector<StudyMethod> methods = studyMethodsNamed(methodNames);
  requireOwnFolder(folder, "result of a study", isResultName);
  std::deque<NamedScene> scenes;
  loadScenes(paths, scenes);
  makeFolder(folder);
  printPeers(methods);
  Study study(folder, methods, scenes.size(), quiet);
  try {
    for (NamedScene& named : scenes) study.add(named);
  } catch (const Error& error) {
    const std::string part = partPath((fs::path(folder) / kTableName).string());
    throw Error(error.kind(), "", fmt::format("{}; the rows up to then are in {}", error.what(), part));
  }
  study.finish();
}

}  // namespace cradle
