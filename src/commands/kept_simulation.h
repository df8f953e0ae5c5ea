#pragma once

#include <functional>
#include <string>

#include "simulate/simulate.h"

namespace cradle {

/// A simulation whose frames are kept in FILE.part, so that after a kill (SIGKILL, a lost machine) the next one goes
/// on from there. The file goes with the object that has simulated.
class KeptSimulation {
 public:
  /// FILE is `path`. Keeps a reference to `scene`. Throws Error(output) if another run writes FILE.part.
  KeptSimulation(std::string path, const Scene& scene, bool quiet);
  ~KeptSimulation();
  KeptSimulation(const KeptSimulation&) = delete;
  KeptSimulation& operator=(const KeptSimulation&) = delete;

  /// Simulates, and tells `told` all frames and events: those that FILE.part keeps, then its warnings, then new ones.
  /// With `skip`, the number of frames kept is told in place of them. At the end all is in FILE.part. Throws
  /// Error(output) if that cannot be written, and what simulate() throws.
  void run(const SimulationSink& told, const std::function<void(long frames)>& skip = {});

  const std::string& part() const { return part_; }

 private:
  const std::string path_, part_;
  const Scene& scene_;
  const bool quiet_;
  bool isOurs_ = false;  // FILE.part
};

}  // namespace cradle
