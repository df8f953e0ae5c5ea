#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "simulate/assembly.h"
#include "simulate/conservation_record.h"
#include "simulate/corrections.h"
#include "simulate/impact_bumps.h"
#include "simulate/plan/promise.h"
#include "simulate/resting_bodies.h"
#include "simulate/soft_substeps.h"
#include "simulate/spheres/hard_spheres.h"

// Plain records of which a world can be built again, so that it goes on as if nothing had been: all that it is not
// built anew from the scene.

namespace cradle {

/// What an island takes over from those that its bodies were in. Contact steps are those at their last step's end.
struct IslandHistory {
  std::optional<PromiseEnd> promiseEnd;
  bool hasLeftEvents = false;  // for contact steps, once
  bool isInContactSteps = false;
  BumpCounts bumps;
  RestingBodies::Record resting = {};  // of those that it begins with, from a record; empty: that is to be seen
};

/// Bodies that move together.
struct PartRecord {
  std::vector<int> clusters;  // of an island in time; ascending
  std::vector<StartedPush> pushes;
  IslandHistory history;
};

/// Marks those of a part that rest. `sceneBodies`: of its bodies.
void addResting(const PartRecord& part, const std::vector<int>& sceneBodies, std::vector<char>& isResting);

/// An island of the plan, at an instant at which a step ends.
struct IslandRecord {
  VectorX state;
  std::vector<JointState> joints;
  std::vector<PartRecord> parts;  // one; islands in time may be more
  ConservationRecord::Measures measures;
};

/// Those of the plan that may be several islands in time.
struct GroupRecord {
  IslandRecord island;
  std::vector<int> origins, together;  // of each cluster: the first of those that it is joined with, as Twins
  std::optional<PromiseEnd> promiseEnd;
  double stretch = 1;
};

/// A world at a frame, at which all steps end.
struct WorldRecord {
  double time = 0;  // s
  long frame = 0;
  std::vector<IslandRecord> islands;         // in the order of the plan
  std::vector<GroupRecord> groups;           // the same
  std::vector<HardSpheres::Record> spheres;  // the same
  std::vector<SoftSubsteps::Record> softIslands;
  std::vector<std::optional<PromiseEnd>> promiseEnds;
  std::array<char, kCorrectionKinds> isToldOf = {};
  std::array<long, kCorrectionKinds> corrections = {};
  long evaluations = 0;
};

}  // namespace cradle
