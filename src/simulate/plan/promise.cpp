// Events serve contacts of spheres, corners and faces (simulate/rows_of_contacts.h, canLast) while their rows are few
// and do not change too fast (simulate/plan/event_rate_limit.h). Bounds here are on the safe side: a promise without
// conditions is one that the run never gives up.

#include "simulate/plan/promise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "constraints/disjoint_sets.h"
#include "core/printable.h"
#include "simulate/colliders.h"
#include "simulate/plan/event_rate_limit.h"
#include "simulate/plan/plan.h"
#include "simulate/plan/plan_islands.h"

namespace cradle {
namespace {

constexpr int kFewSphereRows = 60;     // of spheres that touch: the most that can be independent, solved in 1 ms
constexpr double kBounces = 16;        // times 1 / (1 - e): bounces of a sphere from 1/60 s before its rest, e near 1
constexpr double kFewBounces = 5e3;    // a quarter of those that kLongEventRateLimit has
constexpr double kFarMassRatio = 1e6;  // contacts under a body as much heavier lose six digits
constexpr double kLevelSlope = 1e-9;   // sine: flatter is level
constexpr int kFaceContacts = 8;       // of two faces, or of a face and a plane: patches have no more points
constexpr int kManyContacts = 64;      // of a mesh

/// Bounds over all contacts that may come about in an island.
struct PossibleContacts {
  // Scene bodies: polytopes that meet each other, cylinders that meet other than planes, meshes that meet other than
  // planes and spheres, cylinders that may tip, moving bodies that may touch.
  std::vector<int> edgeOwners, rimOwners, meshes, tippers, movers;
  bool hasFriction = false, areRound = true;  // round: of spheres with each other and with planes alone
  bool hasSlopes = false;                     // planes with friction that are not level
  bool mayWedge = false;                      // moving bodies with friction between each other
  double restitution = 0;                     // largest below 1
  int rows = 0, treeRows = 0;  // of all contacts; of one contact of each pair, as long as pairs close no loop
};

/// The surface of a body, as far as contacts depend on it.
struct Surface {
  std::optional<ColliderKind> kind;  // none: a plane
  int faceCorners = kFaceContacts;   // of the largest face

  bool isPlane() const { return !kind; }
  bool isRound() const { return !kind || kind == ColliderKind::sphere; }
};

Surface surfaceOf(const Body& body, const Scene& scene) {
  const auto collider = colliderOf(body, scene, kFixed);
  if (!collider) return {};
  Surface surface{collider->kind()};
  if (surface.kind != ColliderKind::polytope) return surface;
  std::size_t corners = 0;
  for (const Polytope::Face& face : collider->polytope->faces) corners = std::max(corners, face.loop.size());
  surface.faceCorners = std::min(kFaceContacts, static_cast<int>(corners));
  return surface;
}

/// Contacts that two surfaces can have at once.
int contactsOf(const Surface& a, const Surface& b) {
  const auto is = [&](ColliderKind kind) { return a.kind == kind || b.kind == kind; };
  const bool isOnPlane = a.isPlane() || b.isPlane();
  if (is(ColliderKind::mesh) && !isOnPlane) return kManyContacts;
  if (is(ColliderKind::sphere)) return 1;
  if (is(ColliderKind::capsule)) return 2;
  return isOnPlane ? std::min(a.faceCorners, b.faceCorners) : kFaceContacts;
}

/// The contacts of all pairs of an island that may collide.
class ContactSurvey {
 public:
  ContactSurvey(const Scene& scene, const IslandPlan& island, const ReachablePairs& reachable)
      : scene_(scene), touching_(island.touching), loops_(touching_.size() + 1), parts_(touching_.size()) {
    for (std::size_t i = 0; i < touching_.size(); ++i) surfaces_.push_back(surfaceOf(bodyOf(i), scene));
    if (island.touching.size() > kManyBodies && reachable.boundless())
      surveyKinds(reachable);
    else
      surveyPairs(reachable);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (parts_[i].ownsEdge) found_.edgeOwners.push_back(touching_[i]);
      if (parts_[i].ownsRim) found_.rimOwners.push_back(touching_[i]);
      if (parts_[i].isMesh) found_.meshes.push_back(touching_[i]);
      if (parts_[i].mayTip) found_.tippers.push_back(touching_[i]);
      if (parts_[i].moves) found_.movers.push_back(touching_[i]);
    }
  }

  const PossibleContacts& found() const { return found_; }

 private:
  /// The part of a body in the contacts that it may have.
  struct Part {
    bool ownsEdge = false, ownsRim = false, isMesh = false, mayTip = false, moves = false;
  };

  // Bodies are named by their places in touching_ from here on.

  void surveyPairs(const ReachablePairs& reachable) {
    for (std::size_t i = 0; i < touching_.size(); ++i)
      for (std::size_t j = i + 1; j < touching_.size(); ++j)
        if (reachable.mayCollide(touching_[i], touching_[j])) add(i, j);
  }

  /// Each body with some of each kind of body that it may collide with: bodies of one kind have the same contacts. Rows
  /// are many in any case.
  void surveyKinds(const ReachablePairs& reachable) {
    constexpr std::size_t kTried = 4;  // of a kind: joints seldom keep more from one body
    std::map<std::tuple<int, int, int, bool, bool>, std::vector<std::size_t>> kinds;
    for (std::size_t body = 0; body < touching_.size(); ++body) {
      const Surface& surface = surfaces_[body];
      std::vector<std::size_t>& alike =
          kinds[{surface.kind ? static_cast<int>(*surface.kind) : -1, surface.faceCorners, bodyOf(body).material,
                 bodyOf(body).motion == Motion::dynamic, isSlope(body)}];
      if (alike.size() < kTried) alike.push_back(body);
    }
    for (std::size_t body = 0; body < touching_.size(); ++body)
      for (const auto& [kind, alike] : kinds)
        for (const std::size_t other : alike)
          if (other != body && reachable.mayCollide(touching_[body], touching_[other])) addKinds(body, other);
    found_.rows = kManyRows;
  }

  const Body& bodyOf(std::size_t body) const { return scene_.bodies[static_cast<std::size_t>(touching_[body])]; }

  const SurfacePair& materialOf(std::size_t a, std::size_t b) const {
    return scene_
        .surfacePairs[static_cast<std::size_t>(bodyOf(a).material)][static_cast<std::size_t>(bodyOf(b).material)];
  }

  /// Adds edges, friction and restitution of the contact of two bodies.
  void addKinds(std::size_t a, std::size_t b) {
    const Surface &surfaceA = surfaces_[a], &surfaceB = surfaces_[b];
    const auto isMoving = [&](std::size_t body) { return bodyOf(body).motion == Motion::dynamic; };
    for (const std::size_t body : {a, b})
      if (isMoving(body)) parts_[body].moves = true;
    addEdges(a, surfaceA, surfaceB);
    addEdges(b, surfaceB, surfaceA);
    const SurfacePair& material = materialOf(a, b);
    found_.hasFriction = found_.hasFriction || material.staticFriction > 0;
    found_.hasSlopes = found_.hasSlopes || (material.staticFriction > 0 && (isSlope(a) || isSlope(b)));
    found_.mayWedge = found_.mayWedge || (material.staticFriction > 0 && isMoving(a) && isMoving(b));
    if (material.restitution < 1) found_.restitution = std::max(found_.restitution, material.restitution);
  }

  /// Adds that, and how many rows the contact may have.
  void add(std::size_t a, std::size_t b) {
    addKinds(a, b);
    const int rowsOfOne = materialOf(a, b).staticFriction > 0 ? 3 : 1;
    found_.rows = std::min(found_.rows + rowsOfOne * contactsOf(surfaces_[a], surfaces_[b]), kManyRows);
    const int placeA = placeOf(a), placeB = placeOf(b);
    if (loops_.islandOf(placeA) == loops_.islandOf(placeB)) return;
    loops_.join(placeA, placeB);
    found_.treeRows += rowsOfOne;
  }

  /// On a slope a sphere may slide slowly for long.
  bool isSlope(std::size_t body) const {
    const auto* plane = std::get_if<Plane>(&bodyOf(body).shape);
    return plane && (bodyOf(body).worldFromBody.rotation * plane->normal).cross(scene_.gravity).norm() >
                        kLevelSlope * scene_.gravity.norm();
  }

  /// Adds what of a body has no row against the other body.
  void addEdges(std::size_t body, const Surface& own, const Surface& other) {
    if (own.isRound()) return;
    found_.areRound = false;
    Part& part = parts_[body];
    if (own.kind == ColliderKind::polytope && other.kind == ColliderKind::polytope) part.ownsEdge = true;
    if (own.kind == ColliderKind::mesh && !other.isRound()) part.isMesh = true;
    if (own.kind != ColliderKind::cylinder) return;
    part.mayTip = true;
    if (!other.isPlane()) part.ownsRim = true;
  }

  /// The element of a body in the disjoint sets: all fixed bodies are one.
  int placeOf(std::size_t body) const {
    return static_cast<int>(bodyOf(body).motion == Motion::dynamic ? body : touching_.size());
  }

  static constexpr int kManyRows = 1000000;         // far more than the limits
  static constexpr std::size_t kManyBodies = 2000;  // that touch: their pairs are too many to be visited one by one
  const Scene& scene_;
  const std::vector<int>& touching_;  // scene bodies, ascending
  DisjointSets loops_;
  std::vector<Surface> surfaces_;
  std::vector<Part> parts_;
  PossibleContacts found_;
};

bool hasJoints(const IslandPlan& island) {
  return std::any_of(island.links.begin(), island.links.end(),
                     [](const LinkIndex& link) { return link.kind >= LinkKind::ballJoint; });
}

/// Whether bilateral constraints act on the island: rows of contacts may depend on each other through them.
bool hasBilateral(const IslandPlan& island) {
  return std::any_of(island.links.begin(), island.links.end(),
                     [](const LinkIndex& link) { return link.kind != LinkKind::spring; });
}

/// Whether constraints close a loop of two moving bodies or more: a linkage, which may come to a dead point. What is
/// fixed, and what is driven, counts as one body.
bool isLinkage(const Scene& scene, const IslandPlan& island) {
  const int fixed = static_cast<int>(scene.bodies.size());
  const auto elementOf = [&](int body) {
    return body != kWorld && scene.bodies[static_cast<std::size_t>(body)].motion == Motion::dynamic ? body : fixed;
  };
  std::set<std::pair<int, int>> pairs;
  for (const LinkIndex& link : island.links) {
    if (link.kind == LinkKind::spring) continue;
    const auto [a, b] = anchorsOf(link, scene);
    pairs.insert(std::minmax({elementOf(a.body), elementOf(b.body)}));
  }
  return closeALoop(pairs, scene.bodies.size() + 1);
}

int independentRows(const PossibleContacts& contacts) {
  const int ofABody = contacts.areRound && !contacts.hasFriction ? 3 : 6;  // spheres without friction do not rotate
  return std::min(contacts.rows, ofABody * static_cast<int>(contacts.movers.size()));
}

/// Whether the contacts are those of few spheres: events serve them in any case, at a bearable cost.
bool areFewSpheres(const PossibleContacts& contacts) {
  const double bounces = kBounces * static_cast<double>(contacts.movers.size()) / (1 - contacts.restitution);
  return contacts.areRound && !contacts.hasSlopes && independentRows(contacts) <= kFewSphereRows &&
         bounces <= kFewBounces;
}

/// Whether contacts may have too many rows. Contacts that join bodies to a tree are independent of each other, unless
/// constraints act on the bodies.
bool mayHaveManyRows(const PossibleContacts& contacts, bool isConstrained) {
  const int redundant = contacts.rows - (isConstrained ? 0 : contacts.treeRows);
  return redundant > kMaxRedundant || independentRows(contacts) > kMaxIndependent;
}

PromiseCondition slidingCondition(const Scene& scene, const PossibleContacts& contacts) {
  return {fmt::format("no contact of {} jams, or slides so slowly that its friction has no sure direction",
                      namesOfBodies(contacts.movers, scene)),
          contacts.movers};
}

/// Adds that no body squeezes a far lighter one, if there is one.
void addMassCondition(const Scene& scene, const PossibleContacts& contacts, std::vector<PromiseCondition>& conditions) {
  const auto massOf = [&](int body) { return scene.bodies[static_cast<std::size_t>(body)].massProperties.mass; };
  const auto [light, heavy] = std::minmax_element(contacts.movers.begin(), contacts.movers.end(),
                                                  [&](int left, int right) { return massOf(left) < massOf(right); });
  if (light == contacts.movers.end() || massOf(*heavy) <= kFarMassRatio * massOf(*light)) return;
  conditions.push_back({fmt::format("none of {} squeezes another of less than a millionth of its mass",
                                    namesOfBodies(contacts.movers, scene)),
                        contacts.movers});
}

std::vector<PromiseCondition> conditionsOf(const Scene& scene, const IslandPlan& island,
                                           const PossibleContacts& contacts) {
  std::vector<PromiseCondition> conditions;
  const auto add = [&](const char* what, const std::vector<int>& bodies, const char* does) {
    if (!bodies.empty())
      conditions.push_back({fmt::format("no {} of {} {}", what, namesOfBodies(bodies, scene), does), bodies});
  };
  add("edges", contacts.edgeOwners, "press along each other");
  add("rim", contacts.rimOwners, "presses on an edge or a round side");
  add("edge", contacts.meshes, "presses on another body");
  add("cylinder", contacts.tippers, "tips over its rim");
  if (mayHaveManyRows(contacts, hasBilateral(island)))
    conditions.push_back({fmt::format("no more than {} redundant or {} independent forces press {} at once",
                                      kMaxRedundant, kMaxIndependent, namesOfBodies(contacts.movers, scene)),
                          contacts.movers});
  if (contacts.hasFriction && (!contacts.areRound || contacts.hasSlopes))
    conditions.push_back(slidingCondition(scene, contacts));
  if (hasJoints(island))
    conditions.push_back({fmt::format("nothing touches {} within a thousandth of its size of a joint",
                                      namesOfBodies(contacts.movers, scene)),
                          contacts.movers});
  addMassCondition(scene, contacts, conditions);
  const EventRateLimit& patience = scene.accuracy > kVisualAccuracy ? kVisualEventRateLimit : kEventRateLimit;
  conditions.push_back(
      {fmt::format("{} among {}", patience.limit, namesOfBodies(contacts.movers, scene)), contacts.movers});
  return conditions;
}

/// A sphere that slides with friction between others, or on a plane and under another one, may be wedged in.
Promise promiseOfFewSpheres(const Scene& scene, const PossibleContacts& contacts) {
  std::vector<PromiseCondition> conditions;
  if (contacts.mayWedge) conditions.push_back(slidingCondition(scene, contacts));
  addMassCondition(scene, contacts, conditions);
  if (conditions.empty()) return {};
  return {Promise::Kind::conditional, std::move(conditions), {}, true};
}

Promise notPromised(std::string reason) {
  return {Promise::Kind::none, {}, std::move(reason), false};
}

/// The promise of an island but for dead points.
Promise promiseOfContacts(const Scene& scene, const IslandPlan& island, const ReachablePairs& reachable) {
  const ChosenMethod& method = island.method;
  if (method.kind == MotionKind::pile)
    return notPromised(
        fmt::format("many bodies may touch: soft contacts decide, in steps of {:.3g} s at most", method.timeStep));
  if (method.kind == MotionKind::fixedSteps && scene.method)
    return notPromised(fmt::format("the scene names the method: its time step of {:.3g} s decides", method.timeStep));
  if (method.kind == MotionKind::fixedSteps)
    return notPromised(
        fmt::format("models with hollows may touch: their contact is resolved every {:.3g} s", method.timeStep));
  if (method.isClosedForm() || island.touching.empty()) return {};
  const ContactSurvey survey(scene, island, reachable);
  if (areFewSpheres(survey.found()) && !hasJoints(island) && island.driven.empty())
    return promiseOfFewSpheres(scene, survey.found());
  return {Promise::Kind::conditional, conditionsOf(scene, island, survey.found()), {}, false};
}

}  // namespace

Promise promiseOf(const Scene& scene, const IslandPlan& island, const ReachablePairs& reachable) {
  Promise promise = promiseOfContacts(scene, island, reachable);
  if (promise.kind == Promise::Kind::none || island.method.isClosedForm() || !isLinkage(scene, island)) return promise;
  if (promise.kind == Promise::Kind::kept) promise.eventsServe = true;
  promise.kind = Promise::Kind::conditional;
  promise.conditions.push_back(
      {fmt::format("{} come slowly to no dead point", namesOfBodies(island.bodies, scene)), island.bodies});
  return promise;
}

std::string namesOfBodies(const std::vector<int>& bodies, const Scene& scene) {
  constexpr std::size_t kMaxNamedBodies = 4;
  std::string names;
  for (std::size_t i = 0; i < std::min(kMaxNamedBodies, bodies.size()); ++i)
    names += fmt::format("{}{}", i ? ", " : "", printableLine(scene.bodies[static_cast<std::size_t>(bodies[i])].name));
  if (bodies.size() > kMaxNamedBodies) names += fmt::format(" and {} more", bodies.size() - kMaxNamedBodies);
  return names;
}

std::string describe(const Promise& promise) {
  if (promise.kind == Promise::Kind::kept) return "promised";
  if (promise.kind == Promise::Kind::none) return "not promised, because " + promise.reason;
  std::string text = "promised while ";
  for (std::size_t i = 0; i < promise.conditions.size(); ++i)
    text += (i == 0 ? "" : i + 1 < promise.conditions.size() ? ", " : ", and ") + promise.conditions[i].what;
  return text;
}

std::string outcomeOf(const Promise& promise, const std::optional<PromiseEnd>& end, const Scene& scene) {
  if (promise.kind == Promise::Kind::none) return "";
  if (!end) return "kept";
  const std::string names = end->bodies.empty() ? "" : fmt::format(" ({})", namesOfBodies(end->bodies, scene));
  return fmt::format("given up at {:.6g} s, because {}{}", end->time, end->reason, names);
}

}  // namespace cradle
