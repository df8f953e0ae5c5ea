#include "simulate/plan/plan_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/printable.h"
#include "scene/count_bodies.h"

namespace cradle {
namespace {

/// The collider of a model's body, in words.
std::string collisionName(const Body& body, const ModelCollision& model) {
  if (body.collision == CollisionChoice::hull) return "its hull";
  const bool asPrimitive = body.collision != CollisionChoice::mesh || !model.recognised.primitive;
  return asPrimitive ? shapeName(model.recognised) : "convex";
}

/// Islands with the same text are told together, in the order of the first of each.
class AlikeIslands {
 public:
  void add(const IslandPlan& island, const std::string& said) {
    if (!islands_.contains(said)) order_.push_back(said);
    islands_[said].push_back(&island);
  }

  /// Calls tell(names, said) for each kind.
  template <class Tell>
  void forEach(const Scene& scene, const Tell& tell) const {
    for (const std::string& said : order_) {
      const auto& islands = islands_.at(said);
      const std::string more = islands.size() > 1 ? fmt::format("; {} more islands alike", islands.size() - 1) : "";
      tell(namesOfBodies(islands[0]->bodies, scene) + more, said);
    }
  }

 private:
  std::map<std::string, std::vector<const IslandPlan*>> islands_;
  std::vector<std::string> order_;
};

}  // namespace

std::string describe(const ChosenMethod& method) {
  if (method.isClosedForm()) return std::string(method.name);
  if (method.isAdaptive()) return fmt::format("{}, local error below {:.3g} (1 + |x|)", method.name, method.tolerance);
  return fmt::format("{}, step {} s", method.name, method.timeStep);
}

std::vector<std::string> collisionOfModels(const Scene& scene) {
  std::vector<std::string> found;
  for (const Body& body : scene.bodies) {
    const auto* shape = std::get_if<ModelShape>(&body.shape);
    if (!shape || body.collision == CollisionChoice::none) continue;
    const auto model = static_cast<std::size_t>(shape->model);
    const std::string text = fmt::format("{} as {}", printableLine(scene.models[model].name),
                                         collisionName(body, scene.modelCollisions[model]));
    if (std::find(found.begin(), found.end(), text) == found.end()) found.push_back(text);
  }
  return found;
}

std::string methodNames(const Plan& plan) {
  std::vector<std::string> names;
  for (const IslandPlan& island : plan.islands) {
    const std::string name = describe(island.method);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, "; "));
}

std::string accuracyPromised(const Plan& plan) {
  for (const IslandPlan& island : plan.islands)
    if (island.promise.kind == Promise::Kind::none) return describe(island.promise);
  return fmt::format("{:.3g}", plan.accuracy);
}

std::string promiseOfAll(const Plan& plan) {
  const auto isAny = [&](Promise::Kind kind) {
    return std::any_of(plan.islands.begin(), plan.islands.end(),
                       [kind](const IslandPlan& island) { return island.promise.kind == kind; });
  };
  if (isAny(Promise::Kind::none))
    return isAny(Promise::Kind::kept) || isAny(Promise::Kind::conditional) ? "promised of some bodies only"
                                                                           : "not promised";
  return isAny(Promise::Kind::conditional) ? "promised while conditions hold" : "promised";
}

std::string describe(const Plan& plan, const Scene& scene) {
  std::string text = fmt::format("{} {} in {} {}", scene.bodies.size(), scene.bodies.size() == 1 ? "body" : "bodies",
                                 plan.islands.size(), plan.islands.size() == 1 ? "island" : "islands");
  for (const auto& [motion, name] : {std::pair(Motion::fixed, "fixed"), {Motion::driven, "driven"}})
    if (const auto count = countBodies(scene, motion); count > 0) text += fmt::format(", {} {}", count, name);
  const std::vector<std::string> collisions = collisionOfModels(scene);
  if (!collisions.empty()) text += fmt::format("\ncollision of models: {}", fmt::join(collisions, ", "));
  AlikeIslands alike;
  for (const IslandPlan& island : plan.islands) {
    std::string how = fmt::format("\n  method    {}\n  why       {}\n  accuracy  {}", describe(island.method),
                                  island.reason, describe(island.promise));
    for (const std::string_view notNeeded : island.notNeeded) how += fmt::format("\n  left out  {}", notNeeded);
    alike.add(island, how);
  }
  alike.forEach(scene, [&](const std::string& names, const std::string& how) { text += "\n" + names + how; });
  return text;
}

std::string describeOutcome(const Plan& plan, const std::vector<std::optional<PromiseEnd>>& ends, const Scene& scene) {
  AlikeIslands alike;
  for (std::size_t i = 0; i < plan.islands.size(); ++i) {
    const Promise& promise = plan.islands[i].promise;
    const std::string outcome = outcomeOf(promise, ends[i], scene);
    alike.add(plan.islands[i], describe(promise) + (outcome.empty() ? "" : "; " + outcome));
  }
  std::string text;
  alike.forEach(scene, [&](const std::string& names, const std::string& said) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : "\n", names, said);
  });
  return text;
}

}  // namespace cradle
