#include "simulate/twins.h"

#include <algorithm>
#include <tuple>

#include "simulate/thresholds.h"

namespace cradle {

Twins::Twins(const std::vector<int>& origins, const std::vector<int>& together) : Twins(origins.size()) {
  for (int cluster = 0; cluster < std::ssize(origins); ++cluster) {
    origins_.join(origins[static_cast<std::size_t>(cluster)], cluster);
    together_.join(together[static_cast<std::size_t>(cluster)], cluster);
  }
}

void Twins::connect(const std::vector<int>& clusters) {
  for (const int cluster : clusters) origins_.join(clusters.front(), cluster);
}

std::vector<std::pair<int, int>> Twins::find(const std::vector<Instant>& events) {
  origins_.flatten();
  std::vector<std::pair<int, Instant>> ordered;
  for (const Instant& event : events) ordered.emplace_back(origins_.islandOf(event.cluster), event);
  std::sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.time, a.second.cluster) < std::tie(b.first, b.second.time, b.second.cluster);
  });
  std::vector<std::pair<int, int>> twins;
  for (auto first = ordered.begin(); first != ordered.end();) {
    auto end = first + 1;  // of the events that follow each other at one instant
    bool areOfOneIsland = true, areEqual = true;
    for (; end != ordered.end(); ++end) {
      const Instant &before = (end - 1)->second, &event = end->second;
      if (end->first != first->first || event.time > before.time + sameTime(before.time)) break;
      areOfOneIsland = areOfOneIsland && event.island == before.island;
      areEqual = areEqual && event.time == before.time;
    }
    if (!areOfOneIsland && !areEqual)
      for (auto other = first + 1; other != end; ++other)
        if (other->second.island != first->second.island)
          twins.emplace_back(first->second.cluster, other->second.cluster);
    first = end;
  }
  for (const auto& [a, b] : twins) together_.join(a, b);
  return twins;
}

}  // namespace cradle
