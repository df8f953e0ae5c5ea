#include "simulate/overlap_watch.h"

#include <fmt/format.h>

namespace cradle {
namespace {

constexpr double kTouchingOverlap = 1e-9;   // of a half extent: an overlap up to that is touching (docs/scene_file.md)
constexpr double kModelOverlap = 1.2e-7;    // the same of models: their vertices have single precision
constexpr double kUnpromisedOverlap = 0.1;  // of a half extent: how deep bodies may be in others without a promise

bool hasMeshShape(const Body& body) {
  return std::holds_alternative<ModelShape>(body.shape);
}

}  // namespace

OverlapWatch::OverlapWatch(const Scene& scene, const Plan& plan)
    : scene_(scene),
      assembly_(assemble(scene, wholeScene(scene))),
      meter_(assembly_),
      isPromised_(scene.bodies.size(), 0) {
  for (const IslandPlan& island : plan.islands)
    for (const int body : island.bodies)
      isPromised_[static_cast<std::size_t>(body)] = island.promise.kind != Promise::Kind::none;
}

std::optional<Overlap> OverlapWatch::worstOf(const Frame& frame) {
  std::optional<Overlap> worst;
  for (const Contact& contact : meter_.overlapsOf(stateOf(assembly_, frame))) {
    const auto [a, b] = meter_.bodiesOf(contact);
    const Overlap overlap{frame.time, a, b, -contact.separation, allowedDepth(contact)};
    if (!worst || overlap.depth * worst->allowed > worst->depth * overlap.allowed) worst = overlap;
  }
  return worst;
}

double OverlapWatch::allowedDepth(const Contact& contact) const {
  const auto [a, b] = meter_.bodiesOf(contact);
  const Body &bodyA = scene_.bodies[static_cast<std::size_t>(a)], &bodyB = scene_.bodies[static_cast<std::size_t>(b)];
  const bool isPromised = isPromised_[static_cast<std::size_t>(bodyA.motion == Motion::dynamic ? a : b)];
  const double extent = meter_.halfExtent(contact);
  if (!isPromised) return kUnpromisedOverlap * extent;
  const double touching = (hasMeshShape(bodyA) || hasMeshShape(bodyB) ? kModelOverlap : kTouchingOverlap) * extent;
  return scene_.accuracy * (1 + contact.point.norm()) + touching;
}

std::string describe(const Overlap& overlap, const Scene& scene) {
  const auto nameOf = [&](int body) { return scene.bodies[static_cast<std::size_t>(body)].name; };
  return fmt::format("at {:.6g} s \"{}\" is {:.3g} m deep in \"{}\"; {:.3g} m is allowed", overlap.time,
                     nameOf(overlap.bodyA), overlap.depth, nameOf(overlap.bodyB), overlap.allowed);
}

}  // namespace cradle
