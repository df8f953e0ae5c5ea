#include "commands/study_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "commands/simulate_scene.h"
#include "core/console.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/part_lock.h"
#include "core/printable.h"
#include "core/progress.h"
#include "study/gnuplot.h"
#include "study/growing_table.h"
#include "study/unfinished_study.h"
#include "study/work_precision_chart.h"
#include "trajectory/state_hash.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTableName = "study.csv";
constexpr const char* kReferencesName = "references.csv";
constexpr const char* kChartPrefix = "work_precision_";
constexpr std::array<double, 3> kWantedErrors = {1e-3, 1e-6, 1e-9};  // whose cost is printed

/// A scene to study, named in the table as its file is, but for what a terminal obeys.
struct NamedScene {
  NamedScene(StudyOrigin of, Scene loaded) : origin(std::move(of)), scene(std::move(loaded)) {}

  StudyOrigin origin;
  StudyScene scene;
};

bool isResultName(const std::string& name) {
  for (const char* table : {kTableName, kReferencesName})
    if (name == table || name == partPath(table)) return true;
  return name.starts_with(kChartPrefix);
}

std::string chartStem(const std::string& folder, const std::string& scene) {
  return (fs::path(folder) / (kChartPrefix + scene)).string();
}

/// Told before the work rather than after it.
void requireWritableResults(const std::string& folder, const std::deque<NamedScene>& scenes) {
  for (const char* name : {kTableName, kReferencesName}) {
    const std::string table = (fs::path(folder) / name).string();
    requireWritableFile(table);
    requireNoWriter(partPath(table));
  }
  for (const NamedScene& named : scenes) requireWritableChart(chartStem(folder, named.origin.scene));
}

/// Of the running program's file and the methods: what rows follow from beside their scene.
std::string hashOfProgram(const std::vector<StudyMethod>& methods) {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(file), {});
  for (const StudyMethod& method : methods) text += method.name + "\n";
  return textHash(text);
}

void loadScenes(const std::vector<std::string>& paths, const std::string& assetRoot, const std::string& programHash,
                std::deque<NamedScene>& scenes) {
  std::set<std::string> names;
  for (const std::string& path : paths) {
    const std::string name = fs::path(path).stem().string();
    if (!names.insert(name).second)
      throw Error(ErrorKind::usage, path, fmt::format("a second scene file named \"{}\"; rename one", name));
    Scene scene = loadSceneAndWarn(path, {.assetRoot = assetRoot});
    const std::string hash = textHash(programHash + scene.text);
    scenes.emplace_back(StudyOrigin{printableLine(name), hash}, std::move(scene));
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
  show("{}: reference {}; {}\n", named.origin.scene, reference.madeBy, reference.confirmation);
  if (!(reference.uncertainty <= kTrustedUncertainty))
    show("  THE REFERENCE IS UNCERTAIN: errors below {:.1e} mean nothing\n", reference.uncertainty);
  show("  {:<20}{:>12}   CPU s a simulated s for error <= {:.0e}{:>12.0e}{:>12.0e}\n", "", "least error",
       kWantedErrors[0], kWantedErrors[1], kWantedErrors[2]);
  for (const StudyMethod& method : methods) {
    if (!named.scene.missingIn(method).empty()) continue;
    double least = std::numeric_limits<double>::infinity();
    for (const StudyRow& row : rows)
      if (row.method == method.name && row.status == RunStatus::ok) least = std::min(least, row.error);
    show("  {:<20}{:>12}{:>41}{:>12}{:>12}\n", method.name, std::isfinite(least) ? fmt::format("{:.1e}", least) : "-",
         cheapest(rows, method, kWantedErrors[0]), cheapest(rows, method, kWantedErrors[1]),
         cheapest(rows, method, kWantedErrors[2]));
  }
  std::map<std::string, std::string> missing;  // by engine
  for (const StudyMethod& method : methods)
    if (const std::string what = named.scene.missingIn(method); !what.empty()) missing[method.engine()] = what;
  for (const auto& [engine, what] : missing) show("  {} is left out: it does not have {}\n", engine, what);
  for (const StudyRow& row : rows)
    if (row.status == RunStatus::failed) show("  {} at {}: {}\n", row.method, row.setting, printableLine(row.message));
}

/// How each of the other engines' methods is set up.
void printPeers(const std::vector<StudyMethod>& methods) {
  for (const StudyMethod& method : methods)
    if (method.peer)
      show("{:<20}{} {}: {}\n", method.name, method.peer->engine, method.peer->version, method.peer->configuration);
}

/// A study of some scenes under way, from where an interrupted one stopped.
class Study {
 public:
  Study(std::string folder, std::vector<StudyMethod> methods, const std::deque<NamedScene>& scenes, bool quiet)
      : folder_(std::move(folder)),
        methods_(std::move(methods)),
        drawsCharts_(canDrawCharts()),
        earlier_(readUnfinishedStudy(pathOf(kTableName), pathOf(kReferencesName), originsOf(scenes))),
        table_(pathOf(kTableName), kStudyColumns, earlier_.rowBytes),
        references_(pathOf(kReferencesName), kReferenceColumns, earlier_.referenceBytes),
        progress_("Studying", "methods", std::ssize(scenes) * turnsOfScene(), quiet) {
    if (peers().empty())
      show(stderr, "note: built without other engines (CMake: CRADLE_PEERS); only our own methods run\n");
    if (!drawsCharts_) show(stderr, "warning: gnuplot is missing: there will be a table, but no charts\n");
    if (!earlier_.rows.empty())
      show(stderr, "note: going on after the {} rows of {}; remove it to start over\n", earlier_.rows.size(),
           partPath(pathOf(kTableName)));
  }

  /// A scene without a reference, or a chart that cannot be drawn, is a fault to tell in the end: the rest is done.
  void add(NamedScene& named) {
    const std::string& name = named.origin.scene;
    WorkPrecisionChart chart{named.scene.name(), {}, {}, named.scene.duration()};
    if (earlier_.hasFinished(name)) {
      chart.reference = earlier_.referenceOf(name)->reference;
      chart.rows = earlier_.rowsOf(name);
      turns_ += turnsOfScene();
      progress_.skipTo(turns_);
    } else if (!study(named, chart)) {
      return;
    }
    progress_.endLine();
    printFindings(named, chart.reference, methods_, chart.rows);
    draw(chart, name);
  }

  /// Whether what is done so far serves the next run.
  bool isKept() const { return isKept_; }

  /// Throws an error of the first fault's kind, if there was one.
  void finish() {
    references_.complete();
    table_.complete();
    if (fault_) throw Error(*fault_, folder_, "has all of the study but what is told above");
    if (!drawsCharts_)
      throw Error(ErrorKind::output, folder_,
                  "has study.csv, but no charts: gnuplot cannot be started; install the package gnuplot-nox");
  }

 private:
  static std::vector<StudyOrigin> originsOf(const std::deque<NamedScene>& scenes) {
    std::vector<StudyOrigin> origins;
    for (const NamedScene& named : scenes) origins.push_back(named.origin);
    return origins;
  }

  std::string pathOf(const char* name) const { return (fs::path(folder_) / name).string(); }

  /// The methods and the reference.
  long turnsOfScene() const { return std::ssize(methods_) + 1; }

  /// False, and a fault noted, if there is no reference.
  bool study(NamedScene& named, WorkPrecisionChart& chart) {
    try {
      chart.reference = findReference(named.scene, [this] { progress_.update(turns_); });
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::limit) throw;
      note(error);
      turns_ += turnsOfScene();
      return false;
    }
    progress_.update(++turns_);
    const std::string& name = named.origin.scene;
    if (earlier_.referenceOf(name) == nullptr) {
      references_.append(tableLine(ReferenceLine{named.origin, chart.reference}));
      table_.keep();
      isKept_ = true;
    }
    const RowStream rows{earlier_.rowsOf(name), [&](const StudyRow& row) {
                           if (!row.isEarlier) table_.append(tableLine(row));
                           chart.rows.push_back(row);
                           progress_.update(turns_);
                         }};
    for (const StudyMethod& method : methods_) {
      sweep(named.scene, name, method, chart.reference, rows);
      progress_.update(++turns_);
    }
    timeInAnotherTurn(named.scene, methods_, chart.rows, [this] { progress_.update(turns_); });
    std::vector<std::string> lines;
    for (const StudyRow& row : chart.rows) lines.push_back(tableLine(row));
    table_.replaceLast(lines);
    return true;
  }

  void draw(const WorkPrecisionChart& chart, const std::string& name) {
    if (!drawsCharts_) return;
    try {
      drawChart(chart, chartStem(folder_, name));
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) throw;
      note(error);
    }
  }

  void note(const Error& error) {
    progress_.endLine();
    show(stderr, "{}\n", error.what());
    if (!fault_) fault_ = error.kind();
  }

  std::string folder_;
  std::vector<StudyMethod> methods_;
  bool drawsCharts_;
  UnfinishedStudy earlier_;
  GrowingTable table_, references_;
  Progress progress_;
  long turns_ = 0;  // methods and references that are done
  bool isKept_ = !earlier_.references.empty();
  std::optional<ErrorKind> fault_;
};

/// Methods with spaces between them are taken for scenes.
void requireNoMethods(const std::vector<std::string>& paths) {
  const std::vector<StudyMethod> methods = studyMethods();
  for (const std::string& path : paths)
    if (!fs::exists(path) && std::any_of(methods.begin(), methods.end(), [&](const auto& m) { return m.name == path; }))
      throw Error(ErrorKind::usage, path, "is a method; methods have commas between them, as --methods rk4,dop853");
}

}  // namespace

void studyScenes(const std::vector<std::string>& paths, const std::string& assetRoot, const std::string& folder,
                 const std::vector<std::string>& methodNames, bool quiet) {
  const std::vector<StudyMethod> methods = studyMethodsNamed(methodNames);
  requireNoMethods(paths);
  requireOwnFolder(folder, "result of a study", isResultName);
  std::deque<NamedScene> scenes;
  loadScenes(paths, assetRoot, hashOfProgram(methods), scenes);
  const ResultFolder made(folder);
  requireWritableResults(folder, scenes);
  Study study(folder, methods, scenes, quiet);
  printPeers(methods);
  try {
    for (NamedScene& named : scenes) study.add(named);
  } catch (const Error& error) {
    if (!study.isKept()) throw;
    const std::string part = partPath((fs::path(folder) / kTableName).string());
    throw Error(
        error.kind(), "",
        fmt::format("{}; the rows up to then are in {}, and the same command goes on from there", error.what(), part));
  }
  study.finish();
}

}  // namespace cradle
