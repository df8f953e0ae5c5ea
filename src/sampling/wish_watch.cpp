#include "sampling/wish_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "collision/feature_neighbour_list.h"
#include "collision/mesh_surface.h"
#include "collision/separation.h"
#include "core/error.h"
#include "math/elementary.h"
#include "simulate/overlap_meter.h"
#include "simulate/simulate.h"
#include "simulate/world.h"

namespace cradle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMaxMetAngle = std::numbers::pi / 4;  // rad

double angleBetween(const Vec3& a, const Vec3& b) {
  return atan2(a.cross(b).norm(), a.dot(b));
}

double distanceTo(const InsideWish& box, const Vec3& point) {
  return (point - point.cwiseMax(box.min).cwiseMin(box.max)).norm();
}

std::optional<std::size_t> indexOf(const std::vector<int>& bodies, int body) {
  const auto found = std::find(bodies.begin(), bodies.end(), body);
  if (found == bodies.end()) return std::nullopt;
  return static_cast<std::size_t>(found - bodies.begin());
}

}  // namespace

WishWatch::WishWatch(const Scene& scene)
    : scene_(scene),
      assembly_(assemble(scene, wholeScene(scene))),
      outcomes_(unmet(scene.wishes.size())),
      timeErrors_(scene.wishes.size(), kInfinity) {
  for (std::size_t i = 0; i < scene.wishes.size(); ++i)
    if (const auto* contact = std::get_if<ContactWish>(&scene.wishes[i].kind))
      searches_.push_back(searchFor(i, *contact));
}

WishWatch::ContactSearch WishWatch::searchFor(std::size_t wish, const ContactWish& contact) const {
  const auto a = indexOf(assembly_.colliderBodies, contact.bodyA), b = indexOf(assembly_.colliderBodies, contact.bodyB);
  const auto planeA = indexOf(assembly_.planeBodies, contact.bodyA);
  const auto planeB = indexOf(assembly_.planeBodies, contact.bodyB);
  const Body &bodyA = scene_.bodies[static_cast<std::size_t>(contact.bodyA)],
             &bodyB = scene_.bodies[static_cast<std::size_t>(contact.bodyB)];
  const auto pair = std::minmax(contact.bodyA, contact.bodyB);
  if (!mayTouch(bodyA, bodyB) || pairsKeptFromTouching(scene_).contains({pair.first, pair.second}))
    throw Error(ErrorKind::scene, scene_.wishes[wish].where,
                fmt::format("\"{}\" and \"{}\" never touch each other; wish contact of bodies that can", bodyA.name,
                            bodyB.name));
  ColliderPair colliders;
  colliders.againstPlane = planeA || planeB;
  if (colliders.againstPlane)
    colliders.a = planeA ? *b : *a, colliders.b = planeA ? *planeA : *planeB;
  else
    colliders.a = std::min(*a, *b), colliders.b = std::max(*a, *b);
  colliders.near = std::make_shared<FeatureNeighbourList>();
  return {wish, colliders};
}

const BodyState& WishWatch::stateOfBody(const Frame& frame, int body) const {
  return frame.states[static_cast<std::size_t>(indexAmong(assembly_.sceneBodies, body))];
}

double WishWatch::distanceOf(const Wish& wish, const Frame& frame) const {
  if (const auto* up = std::get_if<UpWish>(&wish.kind))
    return angleBetween(stateOfBody(frame, up->body).orientation * up->direction, Vec3::UnitY());
  const auto& inside = std::get<InsideWish>(wish.kind);
  return distanceTo(inside, stateOfBody(frame, inside.body).position);
}

void WishWatch::noteGap(const ContactSearch& search, const VectorX& state) {
  const ContactGeometry& geometry = assembly_.geometry;
  WishOutcome& outcome = outcomes_[search.wish];
  const RigidTransform worldFromA = poseOf(state, geometry.colliders[search.pair.a].body);
  if (separationBound(geometry, search.pair, worldFromA, poseOf(state, bodyBOf(geometry, search.pair))) >=
      outcome.distance)
    return;
  std::vector<std::size_t> features;
  appendFeaturesWithin(geometry, search.pair, worldFromA, outcome.distance, features);
  for (const std::size_t feature : features)
    outcome.distance = std::min(outcome.distance, std::max(0.0, separation(geometry, search.pair, feature, state)));
}

void WishWatch::note(const Frame& frame) {
  for (std::size_t i = 0; i < scene_.wishes.size(); ++i) {
    const Wish& wish = scene_.wishes[i];
    if (std::holds_alternative<ContactWish>(wish.kind)) continue;
    const double error = std::abs(std::min(wish.time, scene_.duration) - frame.time);
    if (error > timeErrors_[i]) continue;
    timeErrors_[i] = error;
    outcomes_[i].distance = distanceOf(wish, frame);
    outcomes_[i].isMet =
        std::holds_alternative<UpWish>(wish.kind) ? outcomes_[i].distance < kMaxMetAngle : outcomes_[i].distance == 0;
  }
  if (std::all_of(searches_.begin(), searches_.end(), [&](const auto& search) { return outcomes_[search.wish].isMet; }))
    return;
  const VectorX state = stateOf(assembly_, frame);
  for (const ContactSearch& search : searches_)
    if (!outcomes_[search.wish].isMet) noteGap(search, state);
}

void WishWatch::note(const Event& event) {
  if (event.kind == EventKind::impact) noteContact(event.bodyA, event.bodyB);
}

void WishWatch::noteContact(int bodyA, int bodyB) {
  for (const ContactSearch& search : searches_) {
    const auto& wish = std::get<ContactWish>(scene_.wishes[search.wish].kind);
    if (std::minmax(wish.bodyA, wish.bodyB) == std::minmax(bodyA, bodyB)) outcomes_[search.wish] = {0, true};
  }
}

bool WishWatch::asksForContacts() const {
  return !searches_.empty();
}

double logLikelihood(const std::vector<Wish>& wishes, const std::vector<WishOutcome>& outcomes) {
  double sum = 0;
  for (std::size_t i = 0; i < wishes.size(); ++i) {
    const double deviations = outcomes[i].distance / wishes[i].deviation;
    sum += deviations * deviations;
  }
  return 0 - sum / 2;  // not -0
}

std::vector<WishOutcome> unmet(std::size_t wishes) {
  return std::vector<WishOutcome>(wishes, WishOutcome{kInfinity, false});
}

WishedMotion simulateWishes(const Scene& scene) {
  WishWatch watch(scene);
  SimulationSink sink{[&](const Frame& frame) { watch.note(frame); }, [&](const Event& event) { watch.note(event); },
                      [](const std::string&) {}};
  if (watch.asksForContacts()) sink.contact = [&](const LastingContact& contact) { watch.note(contact); };
  ImpactCounts impacts;
  try {
    World run(scene);
    simulate(scene, run, sink);
    for (const auto& [body, count] : run.bumpCounts())
      if (count > 0) impacts[scene.bodies[static_cast<std::size_t>(body)].name] = count;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::unstable) throw;
    return {unmet(scene.wishes.size()), -kInfinity, {}};
  }
  return {watch.outcomes(), logLikelihood(scene.wishes, watch.outcomes()), std::move(impacts)};
}

bool areAllMet(const std::vector<WishOutcome>& outcomes) {
  return std::all_of(outcomes.begin(), outcomes.end(), [](const WishOutcome& outcome) { return outcome.isMet; });
}

}  // namespace cradle
