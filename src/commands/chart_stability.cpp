#include "commands/chart_stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/console.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/part_file.h"
#include "core/part_lock.h"
#include "core/progress.h"
#include "study/stability/stability_chart.h"

namespace cradle {
namespace {

constexpr std::array<const char*, 3> kEndings = {".csv", ".svg", ".png"};

bool isMapResultName(const std::string& name) {
  for (const MapEntry& map : stabilityMaps())
    for (const char* ending : kEndings)
      if (name == map.name + ending || name == partPath(map.name + ending)) return true;
  return false;
}

void writeTable(const StabilityMap& map, const std::string& path) {
  PartFile file(path);
  file.write(tableOf(map));
  file.complete();
}

/// Told before the work rather than after it.
void requireWritableMap(const std::string& stem, bool drawsCharts) {
  const PartLock table(stem + ".csv");
  if (drawsCharts) requireWritableChart(stem);
}

/// The time that all maps take, in percent of which progress is told.
class MapClock {
 public:
  MapClock(const std::vector<MapEntry>& maps, bool quiet) : progress_("Mapping", "%", 100, quiet) {
    for (const MapEntry& map : maps) total_ += map.seconds;
  }

  MapProgress of(const MapEntry& map) {
    return [this, &map](double part) {
      throwIfInterrupted();
      progress_.update(std::min(99L, static_cast<long>(100 * (done_ + part * map.seconds) / total_)));
    };
  }
  void finish(const MapEntry& map) {
    done_ += map.seconds;
    progress_.update(static_cast<long>(100 * done_ / total_ + 1e-6));
    progress_.endLine();
  }

 private:
  Progress progress_;
  double total_ = 0, done_ = 0;  // s
};

}  // namespace

void chartStability(const std::string& folder, const std::vector<std::string>& names, bool quiet) {
  namespace fs = std::filesystem;
  const std::vector<MapEntry> maps = stabilityMapsNamed(names);
  requireOwnFolder(folder, "stability map", isMapResultName);
  const ResultFolder made(folder);
  const FolderLock lock(folder, FolderUse::alone);
  const bool drawsCharts = canDrawCharts();
  if (!drawsCharts) show(stderr, "warning: gnuplot is missing: there will be tables, but no charts\n");
  for (const MapEntry& entry : maps) requireWritableMap((fs::path(folder) / entry.name).string(), drawsCharts);
  MapClock clock(maps, quiet);
  for (const MapEntry& entry : maps) {
    const StabilityMap map = entry.make(clock.of(entry));
    CRADLE_CHECK(map.name == entry.name);
    const std::string stem = (fs::path(folder) / map.name).string();
    writeTable(map, stem + ".csv");
    if (drawsCharts) drawChart(map, stem);
    clock.finish(entry);
    show("{}: {}\n", map.name, map.title);
  }
  if (!drawsCharts)
    throw Error(ErrorKind::output, folder,
                "has tables, but no charts: gnuplot cannot be started; install the package gnuplot-nox");
}

}  // namespace cradle
