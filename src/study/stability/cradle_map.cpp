// Momentum and energy alone leave the outcome open: Newton's law for all contacts at once keeps both, but balls that
// touch at rest do not rebound among themselves. Its values in closed form are in references.json, R7x.

#include "study/stability/cradle_map.h"

#include <array>

#include "impact/contact_delassus.h"
#include "impact/generalized_reflections.h"
#include "impact/linear_complementarity.h"
#include "simulate/simulate.h"
#include "study/peers/peer.h"
#include "study/stability/contact_scenes.h"

namespace cradle {
namespace {

constexpr double kPeerTimeStep = 1.0 / 1000;  // s

std::vector<double> speedsIn(const VectorX& state) {
  std::vector<double> speeds;
  for (Eigen::Index body = 0; body < bodyCount(state); ++body) speeds.push_back(linearVelocity(state, body).x());
  return speeds;
}

std::vector<ImpactContact> impactsOf(Assembly& assembly) {
  std::vector<ImpactContact> impacts;
  for (const Contact& contact : contactsAtStart(assembly))
    impacts.push_back({contact, assembly.geometry.pairs[contact.pair].material, 0, Vec3::Zero()});
  return impacts;
}

/// 0 <= lambda perp J v+ + e J v >= 0 over all contacts that touch.
void resolveAllAtOnce(const std::vector<ImpactContact>& impacts, const ImpulseResponse& response, VectorX& state) {
  const Eigen::Index size = std::ssize(impacts);
  std::vector<Contact> contacts;
  for (const ImpactContact& impact : impacts) contacts.push_back(impact.contact);
  const ContactDelassus cones(contacts, response, state);
  const Eigen::VectorXi normals = Eigen::VectorXi::LinSpaced(size, 2, static_cast<int>(3 * size - 1));
  VectorX speeds = cones.velocitiesIn(state)(normals);
  for (Eigen::Index i = 0; i < size; ++i) speeds[i] *= 1 + impacts[static_cast<std::size_t>(i)].material.restitution;
  VectorX impulses = VectorX::Zero(3 * size);
  impulses(normals) = solveLinearComplementarity(cones.matrix()(normals, normals), speeds);
  cones.apply(impulses, state);
}

std::vector<double> speedsInPeer(const Peer& peer) {
  const Scene scene = rowOfFiveBalls(1);
  const Assembly assembly = assemble(scene, wholeScene(scene));
  const auto world = peer.open(scene, assembly, kPeerTimeStep);
  VectorX state = assembly.state;
  world->advance(scene.duration);
  world->read(state);
  return speedsIn(state);
}

MapCurve curveOf(const std::string& name, CurveKind kind, const std::vector<double>& speeds) {
  MapCurve curve{name, kind, {}};
  for (std::size_t i = 0; i < speeds.size(); ++i) curve.points.push_back({static_cast<double>(i + 1), speeds[i]});
  return curve;
}

/// A way to set up another engine, and what it is to a reader who does not know it.
struct PeerWay {
  const char *engine, *name, *role;
};
constexpr const char *kDefaults = "an engine's defaults", *kAdvised = "as its manual advises";
constexpr std::array<PeerWay, 7> kPeerWays = {{{"Bullet", "bullet", kDefaults},
                                               {"Bullet", "bulletTuned", kAdvised},
                                               {"ODE", "ode", kDefaults},
                                               {"ODE", "odeTuned", kAdvised},
                                               {"ODE", "odeQuick", "ODE's iterative solver"},
                                               {"MuJoCo", "mujoco", kDefaults},
                                               {"MuJoCo", "mujocoTuned", kAdvised}}};

/// A panel for each other engine that the program was built with.
void addPeers(StabilityMap& map) {
  for (const PeerWay& way : kPeerWays)
    for (const Peer& peer : peers()) {
      if (peer.name != way.name) continue;
      if (map.panels.back().title != way.engine) map.panels.push_back({way.engine, {}, {}});
      map.panels.back().curves.push_back(curveOf(way.role, CurveKind::series, speedsInPeer(peer)));
    }
}

}  // namespace

std::vector<double> speedsAfter(ImpactLaw law, int moving) {
  const Scene scene = rowOfFiveBalls(moving);
  Assembly assembly = assemble(scene, wholeScene(scene));
  std::vector<ImpactContact> impacts = impactsOf(assembly);
  const ImpulseResponse response(assembly.mechanism.bodies);
  VectorX state = assembly.state;
  switch (law) {
    case ImpactLaw::generalizedReflections:
      resolveReflections(impacts, response, state);
      break;
    case ImpactLaw::pairwise:
      resolvePairwise(impacts, response, state);
      break;
    case ImpactLaw::newtonAllAtOnce:
      resolveAllAtOnce(impacts, response, state);
      break;
  }
  return speedsIn(state);
}

std::vector<double> speedsByPlan(int moving) {
  Scene scene = rowOfFiveBalls(moving);
  scene.output.framesPerSecond = 1 / scene.duration;
  std::vector<double> speeds;
  const auto take = [&](const Frame& frame) {
    speeds.clear();
    for (const BodyState& ball : frame.states) speeds.push_back(ball.linearVelocity.x());
  };
  simulate(scene, {take, [](const Event&) {}, [](const std::string&) {}});
  return speeds;
}

StabilityMap cradleMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "cradle";
  map.title = "Newton's cradle: speeds of five touching balls after one hits the others at 1 m/s";
  map.subtitle =
      "No gravity, no friction, restitution 1, equal balls. The other engines: steps of 1/1000 s, 0.1 s after the "
      "impact.";
  map.paragraph =
      "Right is 0, 0, 0, 0, 1. Generalized reflections, which the plan uses, and impulses pair by pair give that. "
      "Newton's law for all contacts at once keeps momentum and energy as well, and throws the ball back at 3/5 of "
      "its speed, with the other four at 2/5. The other engines, touching balls and steps of 1/1000 s, solve all "
      "contacts at once too, or as soft ones.";
  map.x = linearAxis("ball", "", {0, 6});
  map.y = linearAxis("speed after the impact", "m/s", {});
  map.panels = {
      {"generalized reflections",
       {},
       {curveOf("the law alone", CurveKind::series, speedsAfter(ImpactLaw::generalizedReflections, 1)),
        curveOf("the scene's plan", CurveKind::series, speedsByPlan(1))}},
      {"pair by pair", {}, {curveOf("the law alone", CurveKind::series, speedsAfter(ImpactLaw::pairwise, 1))}},
      {"Newton's law, all at once",
       {},
       {curveOf("the law alone", CurveKind::series, speedsAfter(ImpactLaw::newtonAllAtOnce, 1))}}};
  progress(0.5);
  addPeers(map);
  for (MapPanel& panel : map.panels)
    panel.curves.insert(panel.curves.begin(), curveOf("right", CurveKind::theory, {0, 0, 0, 0, 1}));
  progress(1);
  return map;
}

}  // namespace cradle
