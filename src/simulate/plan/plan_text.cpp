#include "simulate/plan/plan_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace cradle {
namespace {

std::string bodyNames(const IslandPlan& island, const Scene& scene) {
  constexpr std::size_t kMostNames = 4;
  std::string names;
  for (std::size_t i = 0; i < std::min(kMostNames, island.bodies.size()); ++i)
    names += fmt::format("{}{}", i ? ", " : "", scene.bodies[static_cast<std::size_t>(island.bodies[i])].name);
  if (island.bodies.size() > kMostNames) names += fmt::format(" and {} more", island.bodies.size() - kMostNames);
  return names;
}

std::string methodText(const ChosenMethod& method) {
  if (method.isClosedForm()) return std::string(method.name);
  if (method.isAdaptive()) return fmt::format("{}, local error below {:.3g} (1 + |x|)", method.name, method.tolerance);
  return fmt::format("{}, step {} s", method.name, method.timeStep);
}

/// What a model's body is for contact.
std::string collisionName(const Body& body, const ModelCollision& model) {
  if (body.collision == CollisionChoice::hull) return "its hull";
  const bool asPrimitive = body.collision != CollisionChoice::mesh || !model.recognised.primitive;
  return asPrimitive ? shapeName(model.recognised) : "convex";
}

/// "gear.3ds as mesh": the models that may touch something, each way once.
std::string collisionText(const Scene& scene) {
  std::vector<std::string> found;
  for (const Body& body : scene.bodies) {
    const auto* shape = std::get_if<ModelShape>(&body.shape);
    if (!shape || body.collision == CollisionChoice::none) continue;
    const auto model = static_cast<std::size_t>(shape->model);
    const std::string text =
        fmt::format("{} as {}", scene.models[model].name, collisionName(body, scene.modelCollisions[model]));
    if (std::find(found.begin(), found.end(), text) == found.end()) found.push_back(text);
  }
  return found.empty() ? "" : fmt::format("\ncollision of models: {}", fmt::join(found, ", "));
}

}  // namespace

std::string methodNames(const Plan& plan) {
  std::vector<std::string> names;
  for (const IslandPlan& island : plan.islands) {
    const std::string name = methodText(island.method);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, "; "));
}

std::string accuracyPromised(const Plan& plan) {
  for (const IslandPlan& island : plan.islands)
    if (!island.method.isClosedForm() && !island.method.isAdaptive()) return "not promised: decided by the time step";
  return fmt::format("{:.3g}", plan.accuracy);
}

std::string describe(const Plan& plan, const Scene& scene) {
  std::string text = fmt::format("{} {} in {} {}", scene.bodies.size(), scene.bodies.size() == 1 ? "body" : "bodies",
                                 plan.islands.size(), plan.islands.size() == 1 ? "island" : "islands");
  std::size_t fixed = 0;
  for (const Body& body : scene.bodies) fixed += body.motion == Motion::fixed;
  if (fixed > 0) text += fmt::format(", {} fixed", fixed);
  text += collisionText(scene);
  // Islands that are moved alike are told together.
  std::map<std::string, std::vector<const IslandPlan*>> alike;
  std::vector<std::string> order;
  for (const IslandPlan& island : plan.islands) {
    std::string how = fmt::format("\n  method    {}\n  why       {}", methodText(island.method), island.reason);
    for (const std::string_view leftOut : island.leftOut) how += fmt::format("\n  left out  {}", leftOut);
    if (!alike.contains(how)) order.push_back(how);
    alike[how].push_back(&island);
  }
  for (const std::string& how : order) {
    const auto& islands = alike[how];
    const std::string more = islands.size() > 1 ? fmt::format("; {} more islands alike", islands.size() - 1) : "";
    text += fmt::format("\n{}{}{}", bodyNames(*islands[0], scene), more, how);
  }
  return text;
}

}  // namespace cradle
