#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "study/peers/peer.h"

namespace cradle {

/// A way to go through time that a study compares with others.
struct StudyMethod {
  std::string name;   // in study.csv and --methods
  std::string title;  // in charts
  SettingKind setting;
  std::optional<MethodName> method;  // for the scene; unset: the plan chooses
  double stabilityLimit = 0;         // of step x omega; 0: unstable at any step, or the step is not ours to choose
  const Peer* peer = nullptr;        // set: the way of another engine

  bool isPlan() const { return !method && !peer; }
  std::string engine() const { return peer ? peer->engine : "cradle"; }
};

/// All that there are, in the order of charts: our own, then those of the peers that the program was built with.
const std::vector<StudyMethod>& studyMethods();

/// The methods of these names, in the order of studyMethods(); all of them for no names. Throws Error(usage) for a name
/// that is none.
std::vector<StudyMethod> studyMethodsNamed(const std::vector<std::string>& names);

/// Makes the scene go by `method`, one of our own, at `setting` (a time step in s, or an accuracy).
void choose(const StudyMethod& method, double setting, Scene& scene);

}  // namespace cradle
