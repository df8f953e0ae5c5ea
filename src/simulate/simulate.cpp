#include "simulate/simulate.h"

#include <fmt/format.h>

#include "core/cpu_stopwatch.h"
#include "simulate/lasting_contacts.h"
#include "simulate/life_sign.h"
#include "simulate/plan/plan_text.h"
#include "simulate/run_record.h"
#include "simulate/step_loss.h"
#include "simulate/world.h"

namespace cradle {
namespace {

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

void tellOfPromises(World& run, const SimulationSink& sink) {
  for (const PromiseEnd& end : run.takePromiseEnds())
    if (sink.promiseEnd) sink.promiseEnd(end);
  for (const std::string& warning : run.takeWarnings()) sink.warning(warning);
}

void tellOfContacts(LastingContacts& contacts, const SimulationSink& sink) {
  for (const LastingContact& contact : contacts.takeChanged()) sink.contact(contact);
}

void endContacts(LastingContacts& contacts, const SimulationSink& sink) {
  if (!sink.contact) return;
  contacts.finish();
  tellOfContacts(contacts, sink);
}

/// When checkpoints are: at the first frame that no step under way goes beyond, after so much work.
class CheckpointSchedule {
 public:
  /// Keeps a reference to `scene`.
  CheckpointSchedule(const Scene& scene, long work) : scene_(scene), work_(work) {}

  /// To be asked behind each frame: whether it has a checkpoint. If the next one is due, steps are to end at it.
  bool isAt(long frame, World& run) {
    if (next_ > 0) {
      if (frame < next_) return false;
      next_ = 0, workThen_ = 0;  // as the run then goes on from its record
      return true;
    }
    if (run.work() - workThen_ < work_) return false;
    long next = frame + 1;
    while (next < lastFrame(scene_) && frameTime(scene_, next) < run.clock()) ++next;
    workThen_ = run.work();
    if (next >= lastFrame(scene_)) return false;
    next_ = next;
    run.stopAt(frameTime(scene_, next));
    return false;
  }

 private:
  const Scene& scene_;
  long work_, workThen_ = 0;
  long next_ = 0;  // frame; 0: none is due
};

}  // namespace

TrajectoryHeader headerOf(const Scene& scene, const Plan& plan) {
  TrajectoryHeader header;
  header.version = CRADLE_VERSION;
  header.scene = scene.text;
  header.scenePath = scene.path;
  header.method = methodNames(plan);
  header.plan = describe(plan, scene);
  header.accuracy = accuracyPromised(plan);
  header.meshes = scene.models;
  for (const Material& material : scene.materials)
    if (material.texture) header.textures.push_back(material.texture);
  for (const Body& body : scene.bodies) {
    const auto* model = std::get_if<ModelShape>(&body.shape);
    header.bodies.push_back({body.name, body.motion == Motion::dynamic, body.motion == Motion::driven,
                             model ? model->model : -1, shapeText(body.shape), body.massProperties});
  }
  const auto addJoints = [&header](const auto& joints) {
    for (const auto& joint : joints)
      header.joints.push_back({joint.name, joint.kNoun, joint.anchorA.body, joint.anchorB.body});
  };
  addJoints(scene.hinges), addJoints(scene.sliders);
  return header;
}

RunCost simulate(const Scene& scene, const SimulationSink& sink) {
  refuseUnsupported(scene);
  World run(scene);
  return simulate(scene, run, sink);
}

RunCost simulate(const Scene& scene, World& run, const SimulationSink& told, const std::string& record,
                 long checkpointWork) {
  CpuStopwatch integration;
  RunRecord soFar;
  SimulationSink sink = told;
  sink.warning = [&](const std::string& warning) {
    soFar.warnings.push_back(warning);
    told.warning(warning);
  };
  LifeSign sign(sink.reached);
  std::function<void(double)> note;
  if (sink.reached) note = [&sign](double time) { sign.note(time); };
  if (sink.contact) run.tellContacts();
  const auto goOnFrom = [&](const std::string& bytes) {
    soFar = runRecordOf(bytes);
    run.goOnFrom(soFar.world);
    integration = {};
  };
  long first = 0;
  if (record.empty()) {
    for (const std::string& warning : run.startWarnings()) sink.warning(warning);
  } else {
    goOnFrom(record);
    for (const std::string& warning : soFar.warnings) told.warning(warning);
    first = soFar.world.frame + 1;
  }
  LastingContacts& contacts = soFar.contacts;
  const auto secondsOfAll = [&] { return soFar.cpuSeconds + integration.seconds(); };

  const auto frameAt = [&](long number) {
    integration.start();
    try {
      return run.frameAt(number, frameTime(scene, number), note);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::unstable) endContacts(contacts, sink);  // the frames so far may be kept
      throw;
    }
  };
  CheckpointSchedule schedule(scene, checkpointWork);
  for (long number = first; number <= lastFrame(scene); ++number) {
    sign.beginFrame();
    Frame frame = frameAt(number);
    integration.stop();
    for (const Event& event : run.takeEvents(frame.time)) {
      if (sink.contact) contacts.note(event);
      if (isOfLastingContact(event.kind)) continue;
      sink.event(event);
      ++soFar.events;
    }
    tellOfPromises(run, sink);
    for (const Correction& correction : run.takeCorrections()) {
      if (sink.correction) sink.correction(correction);
      sink.warning(describe(correction, scene));
    }
    soFar.energies = StepLoss(scene, soFar.energies).with(frame);
    if (sink.contact) {
      frame.contacts = run.contactWrenches();
      contacts.note(frame);
      tellOfContacts(contacts, sink);
    }
    sink.frame(frame);
    if (!schedule.isAt(number, run)) continue;
    soFar.world = run.record(), soFar.cpuSeconds = secondsOfAll();
    const std::string bytes = bytesOf(soFar);
    if (sink.checkpoint) sink.checkpoint(checkpointOf(soFar, bytes));
    goOnFrom(bytes);
  }
  run.finish();
  endContacts(contacts, sink);
  tellOfPromises(run, sink);
  const auto warning = StepLoss(scene, soFar.energies).warning();
  if (warning && !run.hasLongSteps()) sink.warning(*warning);
  return {secondsOfAll(), run.evaluations(), run.correctionCounts(),
          describeOutcome(run.plan(), run.promiseEnds(), scene)};
}

Trajectory simulate(const Scene& scene) {
  refuseUnsupported(scene);
  World run(scene);
  Trajectory trajectory;
  trajectory.header = headerOf(scene, run.plan());
  SimulationSink sink{[&](const Frame& frame) { trajectory.frames.push_back(frame); },
                      [&](const Event& event) { trajectory.events.push_back(event); }, [](const std::string&) {}};
  sink.contact = [&](const LastingContact& contact) {
    const auto id = static_cast<std::size_t>(contact.id);
    if (id == trajectory.contacts.size()) trajectory.contacts.emplace_back();
    trajectory.contacts[id] = contact;
  };
  trajectory.cost = simulate(scene, run, sink);
  return trajectory;
}

}  // namespace cradle
