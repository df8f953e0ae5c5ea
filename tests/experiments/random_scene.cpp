#include "experiments/random_scene.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <vector>

#include "collision/random_poses.h"
#include "experiments/experiment.h"

namespace cradle {
namespace {

constexpr double kCell = 0.55;  // m: bodies start in cells of their own
constexpr int kRow = 3;         // cells along x and z
constexpr std::array kAccuracies{"1e-3", "1e-5", "1e-7"};

std::string turnText(const Quat& q) {
  return fmt::format(R"({{"w": {}, "x": {}, "y": {}, "z": {}}})", q.w(), q.x(), q.y(), q.z());
}

class RandomScene {
 public:
  explicit RandomScene(unsigned number) : number_(number), random_(number) {}

  std::string text() {
    const bool isWeightless = chance(0.1);
    const Vec3 gravity = isWeightless ? Vec3::Zero() : Vec3(-9.81 * Vec3::UnitY());
    const std::string materials = materialsText();
    addSurroundings();
    addBodies();
    addLinks();
    return fmt::format(R"({{"schema": "cradle-scene/1", "name": "Random {}", "duration": 1, "accuracy": {},
 "output": {{"framesPerSecond": 40}}, "gravity": {},
 "materials": {},
 "bodies": [{}],
 "springs": [{}],
 "ropes": [{}],
 "rods": [{}],
 "ballJoints": [{}],
 "hinges": [{}]}})",
                       number_, kAccuracies[number_ % kAccuracies.size()], vectorText(gravity), materials,
                       fmt::join(bodies_, ",\n  "), fmt::join(springs_, ",\n  "), fmt::join(ropes_, ",\n  "),
                       fmt::join(rods_, ",\n  "), fmt::join(ballJoints_, ",\n  "), fmt::join(hinges_, ",\n  "));
  }

 private:
  double number(double from, double to) { return random_.number(from, to); }
  bool chance(double probability) { return number(0, 1) < probability; }
  int upTo(int count) { return static_cast<int>(number(0, count)); }
  double magnitude(double from, double to) { return std::pow(10, number(from, to)); }

  /// Half of the scenes have frictionless, elastic or dead materials: where laws degenerate.
  std::string materialsText() {
    std::vector<std::string> materials;
    for (const char* name : {"a", "b"}) {
      const double someRestitution = number(0, 1), someFriction = number(0, 1), part = number(0.5, 1);
      const double restitution =
          std::array{someRestitution, someRestitution, 0.0, 1.0}[static_cast<std::size_t>(upTo(4))];
      const double friction = chance(0.25) ? 0 : someFriction;
      const double dynamicFriction = chance(0.5) ? friction : part * friction;
      materials.push_back(fmt::format(R"("{}": {{"restitution": {}, "staticFriction": {}, "dynamicFriction": {}}})",
                                      name, restitution, friction, dynamicFriction));
    }
    return fmt::format("{{{}}}", fmt::join(materials, ", "));
  }

  const char* someMaterial() { return chance(0.5) ? "a" : "b"; }

  /// A shape in a ball of radius 0.25 m.
  std::string someShape() {
    const double a = number(0.06, 0.12), b = number(0.05, 0.2);
    const Vec3 size = Vec3::Constant(0.16) + random_.vector(0.1);
    const std::string mesh = fmt::format(R"({{"mesh": "{}/assets/l_prism.3ds", "scale": {}}})", CRADLE_SOURCE_DIR, a);
    switch (upTo(6)) {
      case 0:
        return fmt::format(R"("shape": {{"sphere": {{"radius": {}}}}})", a);
      case 1:
        return fmt::format(R"("shape": {{"box": {{"size": {}}}}})", vectorText(size));
      case 2:
        return fmt::format(R"("shape": {{"capsule": {{"radius": {}, "length": {}}}}})", a, b);
      case 3:
        return fmt::format(R"("shape": {}, "collision": "hull")", mesh);
      case 4:
        return fmt::format(R"("shape": {{"cylinder": {{"radius": {}, "length": {}}}}})", a, b);
      default:
        return fmt::format(R"("shape": {})", mesh);
    }
  }

  /// Mostly a floor, level or not; now and then fixed bodies below the others.
  void addSurroundings() {
    const bool hasFloor = chance(0.8), isTilted = chance(0.3);
    const Vec3 tilt = random_.vector(0.3);
    const Vec3 normal = isTilted ? Vec3(tilt.x(), 1, tilt.z()) : Vec3(0, 1, 0);
    if (hasFloor)
      bodies_.push_back(fmt::format(
          R"({{"name": "floor", "shape": {{"plane": {{"normal": {}}}}}, "motion": "static", "material": "{}"}})",
          vectorText(normal), someMaterial()));
    const int obstacles = chance(0.4) ? 1 + upTo(3) : 0;
    for (int i = 0; i < obstacles; ++i) {
      const Vec3 cell = kCell * Vec3(upTo(kRow), 0, i);
      const Quat turn = random_.turn();
      const std::string shape = someShape();
      bodies_.push_back(fmt::format(
          R"({{"name": "fixed{}", {}, "motion": "static", "material": "{}", "position": {}, "orientation": {}}})", i,
          shape, someMaterial(), vectorText(cell), turnText(turn)));
    }
  }

  /// From two to a dozen; in every fiftieth scene a heap of sixty.
  void addBodies() {
    const int few = 2 + upTo(chance(0.2) ? 11 : 5);
    const int count = number_ % 50 == 0 ? 60 : few;
    for (int i = 0; i < count; ++i) {
      const Vec3 cell(i % kRow, 1.4 + i / (kRow * kRow), i / kRow % kRow);
      const Vec3 jitter = random_.vector(0.02);
      const Vec3 toward = 0.3 * (Vec3(0.5 * kCell, 0.6, 0.5 * kCell) - kCell * cell);
      const Vec3 velocity = random_.vector(1.5) + toward;
      const bool turns = chance(0.7), isUpright = chance(0.3);
      const Vec3 spin = turns ? random_.vector(8) : Vec3::Zero();
      const Quat turn = isUpright ? Quat::Identity() : random_.turn();
      const double mass = magnitude(-1, 1);
      const std::string shape = someShape();
      places_.push_back({turn, kCell * cell + jitter});
      bodies_.push_back(fmt::format(R"({{"name": "b{}", {}, "mass": {}, "material": "{}", "position": {},
   "orientation": {}, "linearVelocity": {}, "angularVelocity": {}}})",
                                    i, shape, mass, someMaterial(), vectorText(places_.back().translation),
                                    turnText(turn), vectorText(velocity), vectorText(spin)));
    }
  }

  /// Two ends of a link: a body, and another or the world.
  struct Ends {
    int a, b;  // b < 0: the world
    Vec3 anchorA, anchorB;
    double distance;  // m
  };

  Vec3 inWorld(int body, const Vec3& point) const {
    return body < 0 ? point : Vec3(places_[static_cast<std::size_t>(body)] * point);
  }
  Vec3 inBody(int body, const Vec3& point) const {
    if (body < 0) return point;
    const RigidTransform& place = places_[static_cast<std::size_t>(body)];
    return place.rotation.conjugate() * (point - place.translation);
  }
  std::string endsText(const Ends& ends) const {
    const std::string other = ends.b < 0 ? "" : fmt::format(R"("bodyB": "b{}", )", ends.b);
    return fmt::format(R"("bodyA": "b{}", {}"anchorA": {}, "anchorB": {})", ends.a, other, vectorText(ends.anchorA),
                       vectorText(ends.anchorB));
  }

  /// At the bodies' middles, or off them.
  Ends someEnds() {
    const int count = static_cast<int>(places_.size());
    Ends ends{upTo(count), -1, Vec3::Zero(), Vec3::Zero(), 0};
    const int other = upTo(count);
    const bool isToWorld = chance(0.3), isCentered = chance(0.3);
    if (!isToWorld && other != ends.a) ends.b = other;
    const Vec3 offA = random_.vector(0.08), offB = random_.vector(0.08);
    const Vec3 worldPoint = inWorld(ends.a, Vec3::Zero()) + random_.vector(0.5);
    if (!isCentered) ends.anchorA = offA;
    ends.anchorB = ends.b < 0 ? worldPoint : offB;
    ends.distance = (inWorld(ends.a, ends.anchorA) - inWorld(ends.b, ends.anchorB)).norm();
    return ends;
  }

  void addSpring() {
    const Ends ends = someEnds();
    const double stiffness = magnitude(0.5, 3), someDamping = magnitude(-2, 1), rest = number(0.7, 1.2);
    const double damping = chance(0.5) ? someDamping : 0;
    springs_.push_back(fmt::format(R"({{{}, "stiffness": {}, "damping": {}, "restLength": {}}})", endsText(ends),
                                   stiffness, damping, rest * ends.distance));
  }

  void addRope() {
    const Ends ends = someEnds();
    const double slack = number(0, 0.3), someRestitution = number(0, 1);
    const double length = (chance(0.2) ? 1 : 1 + slack) * ends.distance,
                 restitution = chance(0.4) ? 0 : someRestitution;
    ropes_.push_back(fmt::format(R"({{{}, "maxLength": {}, "restitution": {}}})", endsText(ends), length, restitution));
  }

  /// At most one a pair of bodies, and no closed chains: those may hold each other in places where they jam.
  bool mayTie(const Ends& ends) {
    ties_.resize(places_.size() + 1, -1);
    const auto rootOf = [&](int body) {
      auto at = static_cast<std::size_t>(body < 0 ? std::ssize(places_) : body);
      while (ties_[at] >= 0) at = static_cast<std::size_t>(ties_[at]);
      return static_cast<int>(at);
    };
    const int rootA = rootOf(ends.a), rootB = rootOf(ends.b);
    if (rootA == rootB) return false;
    ties_[static_cast<std::size_t>(rootA)] = rootB;
    return true;
  }

  void addTie() {
    Ends ends = someEnds();
    const int kind = upTo(3);
    const Vec3 axis = random_.direction();
    if (!mayTie(ends) || ends.distance < 0.1) return;
    if (kind == 0) {
      rods_.push_back(fmt::format("{{{}}}", endsText(ends)));
      return;
    }
    const Vec3 joint = (inWorld(ends.a, Vec3::Zero()) + inWorld(ends.b, ends.anchorB)) / 2;
    ends.anchorA = inBody(ends.a, joint), ends.anchorB = inBody(ends.b, joint);
    if (kind == 1)
      ballJoints_.push_back(fmt::format("{{{}}}", endsText(ends)));
    else
      hinges_.push_back(fmt::format(R"({{{}, "axis": {}}})", endsText(ends), vectorText(axis)));
  }

  /// A quarter of the scenes has none.
  void addLinks() {
    if (chance(0.25)) return;
    const int springs = upTo(4), ropes = upTo(4), ties = upTo(4);
    for (int i = 0; i < springs; ++i) addSpring();
    for (int i = 0; i < ropes; ++i) addRope();
    for (int i = 0; i < ties; ++i) addTie();
  }

  unsigned number_;
  RandomPoses random_;
  std::vector<RigidTransform> places_;  // of the bodies that move
  std::vector<std::string> bodies_, springs_, ropes_, rods_, ballJoints_, hinges_;
  std::vector<int> ties_;  // of each body, then the world: another one that it is tied to, or -1
};

}  // namespace

std::string randomSceneText(unsigned number) {
  return RandomScene(number).text();
}

}  // namespace cradle
