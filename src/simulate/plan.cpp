// Rules of the plan. The first that applies to an island is taken:
//   1. the scene names a method: that one, for studies
//   2. balls bounce without loss, and nothing acts but uniform gravity: closed form between collisions
//   3. many bodies may touch, only gravity acts, and the accuracy asked is coarse: the fast contact step
//   4. something may touch, and the accuracy asked is coarse: RK4 with a fixed step, lasting contact resolved once a
//   step
//   5. nothing acts but uniform gravity: closed form
//   6. else DOP853 with steps as long as the accuracy allows; contact changes at events

#include "simulate/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/explicit_euler.h"
#include "dynamics/integrators/rk4.h"
#include "dynamics/integrators/semi_implicit_euler.h"
#include "dynamics/rigid_body.h"
#include "simulate/colliders.h"
#include "simulate/flying_balls.h"
#include "simulate/islands.h"
#include "simulate/reach.h"

namespace cradle {
namespace {

constexpr double kEventAccuracy = 1e-4;     // at coarser ones contact is resolved once a step
constexpr double kPileTimeStep = 1.0 / 60;  // s, at most
constexpr std::size_t kPileBodies = 50;     // with fewer, RK4 costs less than the pictures of its frames
constexpr double kTolerancePart = 0.1;      // of the accuracy: the local errors of about ten steps add up to it

/// What reaches of bodies are compared with: their size around the centre of mass.
double sizeOf(const Body& body, const Scene& scene) {
  const auto collider = colliderOf(body, scene, 0);
  return collider ? collider->boundingRadius : 0;
}

/// A fixed body's collider stands in the world: its size around the place of its frame.
double fixedSizeOf(const Body& body, const Scene& scene) {
  const auto collider = colliderOf(body, scene, -1);
  double size = 0;
  if (!collider) return size;
  for (const Vec3& point : collider->points)
    size = std::max(size, (point - body.worldFromBody.translation).norm() + collider->radius + collider->rimRadius);
  return size;
}

std::vector<double> sizesOf(const Scene& scene) {
  std::vector<double> sizes;
  for (const Body& body : scene.bodies)
    sizes.push_back(body.motion == Motion::dynamic ? sizeOf(body, scene) : fixedSizeOf(body, scene));
  return sizes;
}

bool canMeet(const Reach& a, double sizeA, const Reach& b, double sizeB) {
  return (a.center - b.center).norm() <= a.radius + b.radius + sizeA + sizeB;
}

bool canMeetPlane(const Reach& reach, double size, const Body& plane) {
  const Vec3 normal = plane.worldFromBody.rotation * std::get<Plane>(plane.shape).normal;
  return normal.dot(reach.center - plane.worldFromBody.translation) <= reach.radius + size;
}

/// Bodies that a ball joint or a hinge joins do not touch each other.
std::set<std::pair<int, int>> joinedPairs(const Scene& scene) {
  std::set<std::pair<int, int>> pairs;
  const auto add = [&](const auto& joints) {
    for (const auto& joint : joints) pairs.insert(std::minmax(joint.anchorA.body, joint.anchorB.body));
  };
  add(scene.ballJoints), add(scene.hinges);
  return pairs;
}

/// Which bodies may touch each other, as far as their reaches tell.
class Meetings {
 public:
  Meetings(const Scene& scene, const std::vector<Reach>& reaches)
      : scene_(scene), reaches_(reaches), sizes_(sizesOf(scene)), joined_(joinedPairs(scene)) {}

  void setReaches(const std::vector<Reach>& reaches) { reaches_ = reaches; }

  bool mayMeet(int first, int second) const {
    const auto i = static_cast<std::size_t>(first), j = static_cast<std::size_t>(second);
    const Body &a = scene_.bodies[i], &b = scene_.bodies[j];
    if (!mayTouch(a, b)) return false;
    const bool meet = std::holds_alternative<Plane>(a.shape) ? canMeetPlane(reaches_[j], sizes_[j], a)
                      : std::holds_alternative<Plane>(b.shape)
                          ? canMeetPlane(reaches_[i], sizes_[i], b)
                          : canMeet(reaches_[i], sizes_[i], reaches_[j], sizes_[j]);
    return meet && (joined_.empty() || !joined_.contains(std::minmax(first, second)));
  }

 private:
  const Scene& scene_;
  std::vector<Reach> reaches_;
  std::vector<double> sizes_;
  std::set<std::pair<int, int>> joined_;
};

/// Bodies that touch something, by body.
std::vector<char> findTouching(const Scene& scene, const Meetings& meetings) {
  std::vector<char> touches(scene.bodies.size(), 0);
  for (int i = 0; i < std::ssize(touches); ++i)
    for (int j = i + 1; j < std::ssize(touches); ++j) {
      char &first = touches[static_cast<std::size_t>(i)], &second = touches[static_cast<std::size_t>(j)];
      if (!(first && second) && meetings.mayMeet(i, j)) first = second = 1;
    }
  return touches;
}

/// Bodies that touch something may be thrown anywhere that their ties allow: the search goes on until it finds no more.
Meetings findMeetings(const Scene& scene) {
  std::vector<char> touches(scene.bodies.size(), 0);
  Meetings meetings(scene, reachOf(scene, touches));
  while (true) {
    const std::vector<char> found = findTouching(scene, meetings);
    if (found == touches) return meetings;
    touches = found;
    meetings.setReaches(reachOf(scene, touches));
  }
}

template <class Tie>
void forEachLink(const Scene& scene, const Tie& tie) {
  const auto all = [&](const auto& links) {
    for (const auto& link : links) tie(link.anchorA.body, link.anchorB.body);
  };
  all(scene.springs), all(scene.rods), all(scene.ropes), all(scene.ballJoints), all(scene.hinges);
}

int movingOr(const Scene& scene, int body) {
  return body != kWorld && scene.bodies[static_cast<std::size_t>(body)].motion == Motion::dynamic ? body : kWorld;
}

/// Moving bodies that depend on each other.
Islands joinIslands(const Scene& scene, const Meetings& meetings) {
  Islands joined(scene.bodies.size());
  forEachLink(scene, [&](int a, int b) { joined.join(movingOr(scene, a), movingOr(scene, b)); });
  for (int i = 0; i < std::ssize(scene.bodies); ++i)
    for (int j = i + 1; j < std::ssize(scene.bodies); ++j) {
      if (movingOr(scene, i) == kWorld || movingOr(scene, j) == kWorld) continue;
      if (joined.islandOf(i) != joined.islandOf(j) && meetings.mayMeet(i, j)) joined.join(i, j);
    }
  return joined;
}

/// The bodies of an island that may touch, and the fixed ones that they may touch.
std::vector<int> touchingOf(const Scene& scene, const IslandPlan& island, const Meetings& meetings) {
  std::vector<int> touching;
  for (int other = 0; other < std::ssize(scene.bodies); ++other) {
    const bool moves = movingOr(scene, other) != kWorld;
    if (moves && !std::binary_search(island.bodies.begin(), island.bodies.end(), other)) continue;
    const auto meetsOther = [&](int body) { return body != other && meetings.mayMeet(body, other); };
    bool meets = std::any_of(island.bodies.begin(), island.bodies.end(), meetsOther);
    for (int body = 0; moves && !meets && body < std::ssize(scene.bodies); ++body)
      meets = movingOr(scene, body) == kWorld && meetsOther(body);
    if (meets) touching.push_back(other);
  }
  return touching;
}

/// Islands with their bodies and what these may touch; methods are chosen later.
std::vector<IslandPlan> findIslands(const Scene& scene) {
  const Meetings meetings = findMeetings(scene);
  const Islands joined = joinIslands(scene, meetings);
  std::map<int, IslandPlan> islands;
  for (int body = 0; body < std::ssize(scene.bodies); ++body)
    if (movingOr(scene, body) != kWorld) islands[joined.islandOf(body)].bodies.push_back(body);
  std::vector<IslandPlan> ordered;
  for (auto& [first, island] : islands) {
    island.touching = touchingOf(scene, island, meetings);
    ordered.push_back(std::move(island));
  }
  return ordered;
}

ChosenMethod namedMethod(const Scene& scene) {
  const double timeStep = scene.method->timeStep.value_or(kContactTimeStep);
  switch (scene.method->name) {
    case MethodName::explicitEuler:
      return {explicitEuler, "explicit Euler", timeStep};
    case MethodName::semiImplicitEuler:
      return {semiImplicitEuler, "semi-implicit Euler", timeStep};
    case MethodName::rk4:
      return {rk4, "RK4", timeStep};
    case MethodName::dop853:
      break;
  }
  return {dop853, "DOP853", scene.method->timeStep.value_or(0), kTolerancePart * scene.accuracy};
}

bool isActedUpon(const Scene& scene, const IslandPlan& island) {
  const auto isIn = [&](int body) { return std::binary_search(island.bodies.begin(), island.bodies.end(), body); };
  bool found = std::any_of(scene.pushes.begin(), scene.pushes.end(), [&](const Push& push) { return isIn(push.body); });
  forEachLink(scene, [&](int a, int b) { found = found || isIn(a) || isIn(b); });
  return found;
}

/// Balls on which no torque can act: their spin is constant, whatever moves their centres.
void findUnturned(const Scene& scene, IslandPlan& island) {
  std::vector<char> isTurned(scene.bodies.size(), 0);
  const auto turn = [&](int body) {
    if (body != kWorld) isTurned[static_cast<std::size_t>(body)] = 1;
  };
  const auto turnIfOffCenter = [&](const Anchor& anchor) {
    if (anchor.body == kWorld) return;
    const Body& body = scene.bodies[static_cast<std::size_t>(anchor.body)];
    if (anchor.point != body.massProperties.centerOfMass) turn(anchor.body);
  };
  const auto look = [&](const auto& links) {
    for (const auto& link : links) turnIfOffCenter(link.anchorA), turnIfOffCenter(link.anchorB);
  };
  look(scene.springs), look(scene.rods), look(scene.ropes), look(scene.ballJoints);
  for (const Hinge& hinge : scene.hinges) turn(hinge.anchorA.body), turn(hinge.anchorB.body);
  for (const Push& push : scene.pushes) turn(push.body);
  for (const int body : island.touching) turn(body);
  for (const int body : island.bodies)
    if (!isTurned[static_cast<std::size_t>(body)] &&
        makeRigidBody(scene.bodies[static_cast<std::size_t>(body)].massProperties).isSpherical)
      island.unturned.push_back(body);
}

void choose(const Scene& scene, IslandPlan& island) {
  findUnturned(scene, island);
  if (!island.unturned.empty()) island.leftOut.push_back("no rotation of balls held at their centres: no torque");
  const bool mayTouchSomething = !island.touching.empty();
  if (!mayTouchSomething) island.leftOut.push_back("no search for contact: nothing can touch");
  if (scene.method) {
    island.method = namedMethod(scene);
    island.reason = "the scene names the method";
  } else if (mayTouchSomething && !isActedUpon(scene, island) && flyingBallsOf(scene, island)) {
    island.method = {nullptr, "closed form between collisions", 0, 0, true};
    island.reason = "elastic balls in flight: parabolas, and collisions in the order of time";
    island.leftOut.push_back("no steps, no rotation: nothing turns balls that touch without friction");
  } else if (mayTouchSomething && scene.accuracy > kEventAccuracy && island.bodies.size() >= kPileBodies &&
             !isActedUpon(scene, island)) {
    island.method = {nullptr, "fast contact step", kPileTimeStep, 0, false, true};
    island.reason = "many bodies may touch: soft contacts, sub-stepped; the accuracy asked is not promised";
    island.leftOut.push_back("no motion of bodies that lie still");
  } else if (mayTouchSomething && scene.accuracy > kEventAccuracy) {
    island.method = {rk4, "RK4", kContactTimeStep};
    island.reason = "something may touch: contact is resolved once a step, the accuracy asked is not promised";
  } else if (mayTouchSomething) {
    island.method = {dop853, "DOP853", 0, kTolerancePart * scene.accuracy};
    island.reason = "something may touch: contact changes at events, with steps as long as the accuracy allows between";
  } else if (!isActedUpon(scene, island)) {
    island.method.name = "closed form";
    island.reason = "nothing acts but uniform gravity: parabola and exact free rotation";
    island.leftOut.push_back("no steps: one evaluation a frame");
  } else {
    island.method = {dop853, "DOP853", 0, kTolerancePart * scene.accuracy};
    island.reason = "smooth forces: steps as long as the accuracy allows";
  }
}

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

Plan planOf(const Scene& scene) {
  Plan plan{findIslands(scene), scene.accuracy};
  for (IslandPlan& island : plan.islands) choose(scene, island);
  return plan;
}

IslandPlan wholeScene(const Scene& scene) {
  IslandPlan whole;
  for (const IslandPlan& island : planOf(scene).islands) {
    whole.bodies.insert(whole.bodies.end(), island.bodies.begin(), island.bodies.end());
    whole.touching.insert(whole.touching.end(), island.touching.begin(), island.touching.end());
  }
  for (std::vector<int>* bodies : {&whole.bodies, &whole.touching}) {
    std::sort(bodies->begin(), bodies->end());
    bodies->erase(std::unique(bodies->begin(), bodies->end()), bodies->end());
  }
  return whole;
}

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
