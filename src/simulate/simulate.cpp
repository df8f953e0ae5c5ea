#include "simulate/simulate.h"

#include <fmt/format.h>

#include <ctime>

#include "core/interruption.h"
#include "simulate/simulation.h"
#include "simulate/start_overlaps.h"

namespace cradle {
namespace {

constexpr double kSameTime = 1e-12;  // s, relative beyond 1 s: a frame this near to a step's end is at it

/// CPU time of this thread in s.
double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Frame frameOf(const Simulation& simulation, const VectorX& state, long number, double time) {
  Frame frame{number, time, {}, simulation.energyOf(state)};
  for (Eigen::Index body = 0; body < bodyCount(state); ++body)
    frame.states.push_back({centerOfMass(state, body), orientation(state, body), linearVelocity(state, body),
                            angularVelocity(state, body)});
  return frame;
}

void handOnEvents(Simulation& simulation, const SimulationSink& sink) {
  for (const std::string& warning : simulation.takeWarnings()) sink.warning(warning);
  for (const Event& event : simulation.takeEvents()) sink.event(event);
}

std::string shapeText(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return fmt::format(R"({{"sphere": {{"radius": {}}}}})", sphere->radius);
  if (const auto* box = std::get_if<Box>(&shape))
    return fmt::format(R"({{"box": {{"size": [{}, {}, {}]}}}})", box->size.x(), box->size.y(), box->size.z());
  if (const auto* cylinder = std::get_if<Cylinder>(&shape))
    return fmt::format(R"({{"cylinder": {{"radius": {}, "length": {}}}}})", cylinder->radius, cylinder->length);
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    return fmt::format(R"({{"capsule": {{"radius": {}, "length": {}}}}})", capsule->radius, capsule->length);
  if (const auto* plane = std::get_if<Plane>(&shape))
    return fmt::format(R"({{"plane": {{"normal": [{}, {}, {}]}}}})", plane->normal.x(), plane->normal.y(),
                       plane->normal.z());
  return "";
}

}  // namespace

TrajectoryHeader headerOf(const Scene& scene) {
  const ChosenMethod method = chooseMethod(scene);
  TrajectoryHeader header;
  header.version = CRADLE_VERSION;
  header.scene = scene.text;
  header.scenePath = scene.path;
  header.method = fmt::format("{}, step {} s", method.name, method.timeStep);
  header.plan = scene.method ? "the method that the scene names" : "no plan yet: semi-implicit Euler, step 1/960 s";
  header.accuracy = "not promised: decided by the time step";
  header.meshes = scene.models;
  for (const Body& body : scene.bodies) {
    const auto* model = std::get_if<ModelShape>(&body.shape);
    header.bodies.push_back({body.name, body.motion == Motion::dynamic, model ? model->model : -1,
                             shapeText(body.shape), body.massProperties});
  }
  return header;
}

RunCost simulate(const Scene& scene, const SimulationSink& sink) {
  refuseUnsupported(scene);
  const double start = cpuSeconds();
  Assembly assembly = assemble(scene);
  refuseStartOverlaps(scene, assembly);
  for (const std::string& warning : unusedRequests(scene)) sink.warning(warning);
  for (const std::string& warning : assembly.warnings) sink.warning(warning);
  Simulation simulation(scene, std::move(assembly));
  double cpu = cpuSeconds() - start;

  handOnEvents(simulation, sink);
  sink.frame(frameOf(simulation, simulation.state(), 0, 0));
  long frame = 1;
  while (frame <= lastFrame(scene)) {
    throwIfInterrupted();
    const double before = cpuSeconds();
    simulation.advance();
    cpu += cpuSeconds() - before;

    const double same = kSameTime * std::max(1.0, simulation.time());
    for (; frame <= lastFrame(scene) && frameTime(scene, frame) < simulation.time() - same; ++frame)
      sink.frame(frameOf(simulation, simulation.stateWithin(frameTime(scene, frame)), frame, frameTime(scene, frame)));
    handOnEvents(simulation, sink);
    for (; frame <= lastFrame(scene) && frameTime(scene, frame) <= simulation.time() + same; ++frame)
      sink.frame(frameOf(simulation, simulation.state(), frame, frameTime(scene, frame)));
  }
  return {cpu, simulation.evaluations()};
}

Trajectory simulate(const Scene& scene) {
  Trajectory trajectory;
  trajectory.header = headerOf(scene);
  const SimulationSink sink{[&](const Frame& frame) { trajectory.frames.push_back(frame); },
                            [&](const Event& event) { trajectory.events.push_back(event); }, [](const std::string&) {}};
  trajectory.cost = simulate(scene, sink);
  return trajectory;
}

}  // namespace cradle
