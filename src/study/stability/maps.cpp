#include "study/stability/maps.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "study/stability/bounce_energy_map.h"
#include "study/stability/chains_map.h"
#include "study/stability/coming_to_rest_map.h"
#include "study/stability/cradle_map.h"
#include "study/stability/smooth_motion_maps.h"
#include "study/stability/stacks_map.h"
#include "study/stability/sweeps_map.h"
#include "study/stability/tunnelling_map.h"

namespace cradle {

const std::vector<MapEntry>& stabilityMaps() {
  static const std::vector<MapEntry> maps = {
      {"step_stiffness", 3, stiffnessMap},
      {"step_damping", 2.5, dampingMap},
      {"hung_box_stiffness", 8, hungBoxStiffnessMap},
      {"hung_box_damping", 5, hungBoxDampingMap},
      {"free_rotation", 2, freeRotationMap},
      {"rotation_drift", 0.4, rotationDriftMap},
      {"rod_drift", 0.3, rodDriftMap},
      {"accuracy", 0.1, accuracyMap},
      {"logistic", 0.1, logisticMap},
      {"logistic_step", 0.3, logisticStepMap},
      {"sweeps", 2, sweepsMap},
      {"stacks", 10, stacksMap},
      {"chains", 18, chainsMap},
      {"tunnelling", 2.5, tunnellingMap},
      {"bounce_energy", 0.5, bounceEnergyMap},
      {"coming_to_rest", 0.2, comingToRestMap},
      {"cradle", 0.1, cradleMap},
  };
  return maps;
}

std::vector<MapEntry> stabilityMapsNamed(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const MapEntry& map : stabilityMaps()) known.push_back(map.name);
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(ErrorKind::usage, "--maps",
                  fmt::format("found \"{}\"; allowed are {}", name, fmt::join(known, ", ")));
  std::vector<MapEntry> chosen;
  for (const MapEntry& map : stabilityMaps())
    if (names.empty() || std::find(names.begin(), names.end(), map.name) != names.end()) chosen.push_back(map);
  return chosen;
}

}  // namespace cradle
