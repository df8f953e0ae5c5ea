#include "study/stability/stability_map.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "core/error.h"
#include "study/stability/maps.h"
#include "study/stability/stability_chart.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

StabilityMap sampleMap() {
  StabilityMap map;
  map.name = "sample";
  map.title = "It's a sample";
  map.subtitle = "Made up";
  map.paragraph = "Seen, and why.";
  map.x = logarithmicAxis("stiffness", "N/m", {1, 10, 100});
  map.y = linearAxis("ratio", "", {0, 1});
  map.outcomes = stabilityOutcomes();
  map.panels = {{"A, first", {0, 0, 2, 1, std::nan(""), 2}, {}}, {"B", {}, {}}};
  map.panels[1].curves = {{"limit", CurveKind::theory, {{1, 0.5}, {std::nan(""), 1}, {100, 0.25}}}};
  return map;
}

TEST(StabilityMap, TheTableHasARowForEachCellAndPointAndNamesUnits) {
  EXPECT_EQ(tableOf(sampleMap()),
            "# It's a sample\n# Made up\n# Seen, and why.\npanel,kind,name,stiffness (N/m),ratio\n"
            "\"A, first\",cell,stable,1,0\n\"A, first\",cell,stable,10,0\n\"A, first\",cell,unstable,100,0\n"
            "\"A, first\",cell,inaccurate,1,1\n\"A, first\",cell,unstable,100,1\n"
            "B,theory,limit,1,0.5\nB,theory,limit,100,0.25\n");
}

TEST(StabilityMap, CellsThatAreNumbersHaveAColumn) {
  StabilityMap map = sampleMap();
  map.outcomes.clear();
  map.cell = {"energy gain", "J", false};
  map.panels[0].cells = {1, 2, 3, 4, 5, 0.5};
  const std::string table = tableOf(map);
  EXPECT_THAT(table, HasSubstr("stiffness (N/m),ratio,energy gain (J)\n"));
  EXPECT_THAT(table, HasSubstr("\"A, first\",cell,,100,1,0.5\n"));
}

TEST(StabilityChart, NeighboursOfOneColourAreOneRectangleBetweenTheMiddlesOfValues) {
  // Middles of a logarithmic axis are geometric: 1, 10 -> 3.16; the first border lies as far before 1. 0xa9d3ee is the
  // colour of what is stable.
  const std::string commands = chartCommands(sampleMap(), ChartFormat::svg);
  EXPECT_THAT(commands, HasSubstr("$cells0 << EOD\n0.316227766016837"));
  EXPECT_THAT(commands, HasSubstr(" 11129838\n"));
  const std::string cells = commands.substr(0, commands.find("EOD\n", 20));
  EXPECT_EQ(std::count(cells.begin(), cells.end(), '\n'), 5);  // of six cells two are one, and one is left out
  EXPECT_THAT(commands, HasSubstr("'It''s a sample'"));
}

TEST(StabilityChart, GnuplotDrawsBothFiles) {
  const std::string stem = ::testing::TempDir() + "stability_chart_test";
  StabilityMap map = sampleMap();
  map.outcomes.clear();
  map.cell = {"energy gain", "J", true};
  map.panels[0].cells = {1e-3, 2, 3, 4, 5e3, 0.5};
  drawChart(map, stem);
  for (const char* ending : {".svg", ".png"}) {
    EXPECT_GT(std::filesystem::file_size(stem + ending), 10000U);
    std::filesystem::remove(stem + ending);
  }
}

TEST(StabilityMaps, HaveNamesOfTheirOwnAndUnknownOnesAreRefused) {
  std::set<std::string> names;
  for (const MapEntry& map : stabilityMaps()) {
    EXPECT_TRUE(names.insert(map.name).second) << map.name;
    EXPECT_GT(map.seconds, 0);
  }
  EXPECT_EQ(stabilityMapsNamed({}).size(), names.size());
  EXPECT_EQ(stabilityMapsNamed({"logistic"}).size(), 1U);
  EXPECT_THROW(stabilityMapsNamed({"logistics"}), Error);
}

}  // namespace
}  // namespace cradle
