#include <cradle/simulate.h>

#include <utility>

#include "library/scene_content.h"
#include "library/trajectory_content.h"
#include "library/translated.h"
#include "simulate/assembly.h"
#include "simulate/simulate.h"
#include "simulate/world.h"

namespace cradle::v1 {
namespace {

SimulationSink sinkOf(const Callbacks& callbacks) {
  SimulationSink sink{[&callbacks](const cradle::Frame& frame) {
                        if (callbacks.frame) asThrownByCaller(callbacks.frame, frameOf(frame));
                      },
                      [&callbacks](const cradle::Event& event) {
                        if (callbacks.event) asThrownByCaller(callbacks.event, eventOf(event));
                      },
                      [&callbacks](const std::string& warning) {
                        if (callbacks.warning) asThrownByCaller(callbacks.warning, warning);
                      }};
  if (callbacks.reached) sink.reached = [&callbacks](double time) { asThrownByCaller(callbacks.reached, time); };
  return sink;
}

/// Tells `writer` what it tells `sink`.
void writeAsWell(TrajectoryWriter& writer, SimulationSink& sink) {
  sink.frame = [&writer, told = sink.frame](const cradle::Frame& frame) {
    writer.append(frame);
    told(frame);
  };
  sink.event = [&writer, told = sink.event](const cradle::Event& event) {
    writer.append(event);
    told(event);
  };
  sink.contact = [&writer](const LastingContact& contact) { writer.append(contact); };
}

}  // namespace

Trajectory simulate(const Scene& scene, const Callbacks& callbacks) {
  return translated([scene, callbacks] {  // copies: a callback may give the caller's others
    const cradle::Scene& content = scene.content().loaded.scene;
    refuseUnsupported(content);
    World world(content);
    TrajectoryWriter writer(headerOf(content, world.plan()));
    SimulationSink sink = sinkOf(callbacks);
    writeAsWell(writer, sink);
    writer.finish(cradle::simulate(content, world, sink));
    return Trajectory(
        std::make_shared<Trajectory::Content>(Trajectory::Content{std::make_shared<const TrajectoryReader>(writer)}));
  });
}

void simulateOnly(const Scene& scene, const Callbacks& callbacks) {
  translated([scene, callbacks] {
    SimulationSink sink = sinkOf(callbacks);
    if (callbacks.frame) sink.contact = [](const LastingContact&) {};  // else frames have no contact forces
    cradle::simulate(scene.content().loaded.scene, sink);
  });
}

}  // namespace cradle::v1
