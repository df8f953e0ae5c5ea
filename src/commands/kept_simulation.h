#pragma once

#include <string>

#include "simulate/simulate.h"

namespace cradle {

/// A simulation whose frames are kept in FILE.part, so that after a kill the next one goes on from there. The file goes
/// with the object, unless a signal ends the program.
class KeptSimulation {
 public:
  /// FILE is `path`. Keeps a reference to `scene`.
  KeptSimulation(std::string path, const Scene& scene, bool quiet);
  ~KeptSimulation();
  KeptSimulation(const KeptSimulation&) = delete;
  KeptSimulation& operator=(const KeptSimulation&) = delete;

  /// Tells all of the run, what is kept of it first, its warnings in the end of that. Throws what simulate() throws.
  void run(const SimulationSink& told);

  /// FILE.part.
  std::string part() const;

 private:
  const std::string path_;
  const Scene& scene_;
  const bool quiet_;
};

}  // namespace cradle
