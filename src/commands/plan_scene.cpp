#include "commands/plan_scene.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/warnings.h"
#include "core/console.h"
#include "core/printable.h"
#include "scene/count_bodies.h"
#include "simulate/assembly.h"
#include "simulate/plan/plan_text.h"
#include "simulate/world.h"

namespace cradle {
namespace {

using Json = nlohmann::ordered_json;

Json namesIn(const std::vector<int>& bodies, const Scene& scene) {
  Json names = Json::array();
  for (const int body : bodies) names.push_back(scene.bodies[static_cast<std::size_t>(body)].name);
  return names;
}

Json jsonOf(const IslandPlan& island, const Scene& scene) {
  Json conditions = Json::array();
  for (const PromiseCondition& condition : island.promise.conditions)
    conditions.push_back({{"while", condition.what}, {"bodies", namesIn(condition.bodies, scene)}});
  return {{"bodies", namesIn(island.bodies, scene)},
          {"mayTouch", namesIn(island.touching, scene)},
          {"method", describe(island.method)},
          {"reason", island.reason},
          {"promise", describe(island.promise)},
          {"conditions", conditions},
          {"leftOut", island.notNeeded}};
}

Json jsonOf(const Plan& plan, const Scene& scene, const std::string& scenePath) {
  Json groups = Json::array();
  for (const IslandPlan& island : plan.islands) groups.push_back(jsonOf(island, scene));
  return {{"scene", scenePath},
          {"accuracy", plan.accuracy},
          {"promise", promiseOfAll(plan)},
          {"bodies", scene.bodies.size()},
          {"fixed", countBodies(scene, Motion::fixed)},
          {"driven", countBodies(scene, Motion::driven)},
          {"collisionOfModels", collisionOfModels(scene)},
          {"groups", groups}};
}

}  // namespace

void printPlan(const std::string& scenePath, const SceneOptions& options, bool asJson) {
  const Scene scene = loadSceneAndWarn(scenePath, options);
  refuseUnsupported(scene);
  const World world(scene);
  for (const std::string& warning : world.startWarnings()) warn(warning);
  const Plan& plan = world.plan();
  if (asJson)
    show("{}\n", jsonOf(plan, scene, scenePath).dump(2, ' ', true, nlohmann::json::error_handler_t::replace));
  else
    show("{}: accuracy {:.3g} asked, {}\n{}\n", printableLine(scenePath), plan.accuracy, promiseOfAll(plan),
         describe(plan, scene));
}

}  // namespace cradle
