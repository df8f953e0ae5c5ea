#pragma once

#include <functional>
#include <string>
#include <vector>

#include "study/stability/stability_map.h"

namespace cradle {

/// Told now and then which part of a map is done, 0..1. May throw.
using MapProgress = std::function<void(double part)>;

/// A map that can be made.
struct MapEntry {
  std::string name;    // StabilityMap::name
  double seconds = 0;  // s of CPU time, about: for the time left
  StabilityMap (*make)(const MapProgress& progress) = nullptr;
};

/// All that there are, in the order of a page.
const std::vector<MapEntry>& stabilityMaps();

/// Those of these names, in the order of stabilityMaps(); all of them for no names. Throws Error(usage) for a name that
/// is none.
std::vector<MapEntry> stabilityMapsNamed(const std::vector<std::string>& names);

}  // namespace cradle
