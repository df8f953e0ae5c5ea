#include "commands/plot_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>

#include "commands/trajectory_source.h"
#include "commands/warnings.h"
#include "core/error.h"
#include "core/output_path.h"
#include "core/printable.h"
#include "study/run_chart.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlan = "plan";  // the method that the scene or its plan names

ChartFormat formatOf(const std::string& output) {
  const std::string ending = fs::path(output).extension().string();
  if (ending == ".svg") return ChartFormat::svg;
  if (ending == ".png") return ChartFormat::png;
  throw Error(ErrorKind::usage, output, "cannot tell the format from the name; allowed are FILE.svg and FILE.png");
}

/// What a run is made from.
struct RunOrigin {
  std::string input;   // scene or trajectory
  std::string method;  // of scenes

  bool isScene() const { return !isDatabaseFile(input); }
};

SceneOptions optionsOf(const RunOrigin& origin, const PlotOptions& options) {
  SceneOptions scene = options.scene;
  if (origin.method == kPlan)
    scene.timeStep.reset();
  else
    scene.method = origin.method;
  return scene;
}

/// Each input by the end of its path that no other has, scenes with their method where there are several.
std::vector<std::string> runNames(const std::vector<RunOrigin>& origins, std::size_t methods) {
  const auto stemOf = [](const RunOrigin& origin) { return fs::path(origin.input).stem().string(); };
  const bool isOneScene = std::all_of(origins.begin(), origins.end(),
                                      [&](const RunOrigin& each) { return each.input == origins[0].input; });
  std::vector<std::string> names;
  for (const RunOrigin& origin : origins) {
    const bool isTaken = std::any_of(origins.begin(), origins.end(), [&](const RunOrigin& other) {
      return other.input != origin.input && stemOf(other) == stemOf(origin);
    });
    const std::string name = isTaken ? origin.input : stemOf(origin);
    if (!origin.isScene() || methods <= 1)
      names.push_back(name);
    else
      names.push_back(isOneScene ? origin.method : fmt::format("{}, {}", name, origin.method));
  }
  return names;
}

/// With the time up to which a run went that failed.
std::string shownName(const std::string& name, const TrajectoryReader& run) {
  return run.hasFailed() ? fmt::format("{} (unstable after {:.3g} s)", name, run.frameTimes().back()) : name;
}

/// Of all scenes; of one run with its end, if it failed, as a chart of one run may have no legend.
std::string titleOf(const std::vector<PlottedRun>& runs) {
  constexpr std::size_t kMaxNames = 3;
  std::vector<std::string> names;
  for (const PlottedRun& run : runs)
    if (std::find(names.begin(), names.end(), run.scene.name) == names.end()) names.push_back(run.scene.name);
  if (runs.size() == 1) return shownName(names[0], runs[0].frames);
  const std::size_t more = names.size() - std::min(names.size(), kMaxNames);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

/// A step is that of a method.
void requireStepped(const PlotOptions& options) {
  const bool isTaken = std::any_of(options.methods.begin(), options.methods.end(),
                                   [](const std::string& method) { return method != kPlan; });
  if (options.scene.timeStep && !isTaken)
    throw Error(ErrorKind::usage, "--time-step",
                "found without --methods that take it; name them, as --methods explicitEuler,rk4");
}

std::vector<RunQuantity> quantitiesOf(const PlotOptions& options, const std::deque<TrajectorySource>& sources) {
  std::vector<std::string> names;
  for (const TrajectorySource& source : sources) {
    const std::vector<std::string> more = namesWithCommas(source.scene());
    names.insert(names.end(), more.begin(), more.end());
  }
  std::vector<RunQuantity> quantities;
  for (const std::string& text : options.quantities) {
    const std::vector<RunQuantity> more = parseQuantities(text, names);
    quantities.insert(quantities.end(), more.begin(), more.end());
  }
  return quantities;
}

std::vector<RunOrigin> originsOf(const std::vector<std::string>& inputs, const PlotOptions& options) {
  std::vector<RunOrigin> origins;
  for (const std::string& input : inputs) {
    RunOrigin origin{input, kPlan};
    if (!origin.isScene() || options.methods.empty())
      origins.push_back(origin);
    else
      for (const std::string& method : options.methods) origins.push_back({input, method});
  }
  if (!options.methods.empty() &&
      std::none_of(origins.begin(), origins.end(), [](const auto& o) { return o.isScene(); }))
    throw Error(ErrorKind::usage, "--methods", "found without a scene to simulate: trajectories have their method");
  return origins;
}

void requireReference(const std::vector<RunQuantity>& quantities, const PlotOptions& options) {
  const bool isAsked = std::any_of(quantities.begin(), quantities.end(),
                                   [](const RunQuantity& each) { return each.kind == QuantityKind::error; });
  if (isAsked && options.reference.empty())
    throw Error(ErrorKind::usage, "--quantity", "error needs --reference, the run that errors are measured against");
  if (!isAsked && !options.reference.empty())
    throw Error(ErrorKind::usage, "--reference", "found without --quantity error, which is measured against it");
}

}  // namespace

void plotRuns(const std::vector<std::string>& runs, const std::string& output, const PlotOptions& options, bool quiet) {
  const ChartFormat format = formatOf(output);
  requireStepped(options);
  requireWritableFile(output);
  for (const std::string& run : runs) requireOtherFile(output, run);
  if (!options.reference.empty()) requireOtherFile(output, options.reference);
  if (!canDrawCharts())
    throw Error(ErrorKind::output, output, "gnuplot cannot be started; install the package gnuplot-nox");
  const std::vector<RunOrigin> origins = originsOf(runs, options);
  std::deque<TrajectorySource> sources;  // what is wrong with one shows before any is simulated
  for (const RunOrigin& origin : origins) sources.emplace_back(origin.input, quiet, optionsOf(origin, options));
  if (!options.reference.empty())
    sources.emplace_back(options.reference, quiet, optionsOf({options.reference, kPlan}, options));
  const std::vector<RunQuantity> quantities = quantitiesOf(options, sources);
  requireReference(quantities, options);
  const std::vector<std::string> names = runNames(origins, options.methods.size());
  for (const RunQuantity& quantity : quantities)
    for (std::size_t i = 0; i < sources.size(); ++i)
      requireQuantity(quantity, {i < names.size() ? names[i] : "the reference", sources[i].scene()});
  for (TrajectorySource& source : sources) source.simulateUntilItFails();

  if (!options.reference.empty() && sources.back().reader().hasFailed())
    warn(fmt::format("{}: the reference became unstable after {:.3g} s: no errors are known from there on",
                     options.reference, sources.back().reader().frameTimes().back()));

  std::vector<PlottedRun> shown;
  for (std::size_t i = 0; i < origins.size(); ++i)
    shown.push_back({{shownName(names[i], sources[i].reader()), sources[i].scene()}, sources[i].reader()});
  std::optional<PlottedRun> reference;
  if (!options.reference.empty())
    reference.emplace(PlottedRun{{"the reference", sources.back().scene()}, sources.back().reader()});
  std::vector<RunPanel> panels;
  for (const RunQuantity& quantity : quantities)
    panels.push_back(panelOf(quantity, shown, reference ? &*reference : nullptr));
  drawWithGnuplot(output, format, runChartCommands(titleOf(shown), panels, format));
}

}  // namespace cradle
