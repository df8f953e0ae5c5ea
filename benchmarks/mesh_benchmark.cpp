// What it costs to turn a 3ds file into a body, against assimp's reading of it alone.

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <benchmark/benchmark.h>

#include <assimp/Importer.hpp>

#include "mesh/load_mesh.h"
#include "mesh/mass_properties.h"
#include "mesh/solid.h"

namespace cradle {
namespace {

constexpr const char* kModel = "/usr/share/glmark2/models/asteroid-high.3ds";  // Debian package glmark2-data

void assimpAlone(benchmark::State& state) {
  for (auto _ : state) {
    Assimp::Importer importer;
    if (!importer.ReadFile(kModel, aiProcess_Triangulate)) state.SkipWithError(importer.GetErrorString());
  }
}

void inspection(benchmark::State& state) {
  for (auto _ : state)
    for (const LoadedModel& object : loadObjects(kModel, 1, ModelParts::solidAlone)) {
      benchmark::DoNotOptimize(checkSolid(object.model.solid));
      benchmark::DoNotOptimize(computeMassProperties(object.model.solid, 1));
    }
}

BENCHMARK(assimpAlone)->Unit(benchmark::kMillisecond)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK(inspection)->Unit(benchmark::kMillisecond)->Repetitions(5)->ReportAggregatesOnly();

}  // namespace
}  // namespace cradle

BENCHMARK_MAIN();
