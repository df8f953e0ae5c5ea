#include "commands/kept_simulation.h"

#include <unistd.h>

#include <utility>

#include "commands/run_file.h"
#include "core/output_path.h"
#include "core/part_lock.h"
#include "simulate/world.h"

namespace cradle {

KeptSimulation::KeptSimulation(std::string path, const Scene& scene, bool quiet)
    : path_(std::move(path)), part_(partPath(path_)), scene_(scene), quiet_(quiet) {
  requireNoWriter(part_);
}

KeptSimulation::~KeptSimulation() {
  if (isOurs_) unlink(part_.c_str());  // asks for no memory, which may be what has ended the run
}

void KeptSimulation::run(const SimulationSink& told, const std::function<void(long frames)>& skip) {
  World world(scene_);
  RunFile file(path_, scene_, world, false, false);
  isOurs_ = true;
  if (!quiet_) file.tellOfCheckpoint();
  if (skip)
    skip(file.tellKept([](const Frame&) {}, [](const Event&) {}));
  else
    file.tellKept(told.frame, told.event);
  SimulationSink sink = told;
  sink.frame = [&](const Frame& frame) {
    file.writer().append(frame);
    told.frame(frame);
  };
  sink.event = [&](const Event& event) {
    file.writer().append(event);
    told.event(event);
  };
  sink.contact = [&](const LastingContact& contact) { file.writer().append(contact); };
  sink.checkpoint = [&](Checkpoint checkpoint) {
    checkpoint.fingerprint = file.fingerprint();
    file.writer().append(checkpoint);
  };
  simulate(scene_, world, sink, file.record());
  file.writer().flush();
}

}  // namespace cradle
