#include "trajectory/trajectory.h"

#include <array>

#include "core/error.h"

namespace cradle {
namespace {

constexpr std::array<const char*, 12> kEventKindNames = {"impact", "taut",      "slack",   "rest",
                                                         "slip",   "stick",     "roll",    "release",
                                                         "wake",   "pushStart", "pushEnd", "pushMissed"};

}  // namespace

std::string eventKindName(EventKind kind) {
  return kEventKindNames.at(static_cast<std::size_t>(kind));
}

EventKind eventKindFromName(const std::string& name) {
  for (std::size_t i = 0; i < kEventKindNames.size(); ++i)
    if (name == kEventKindNames[i]) return static_cast<EventKind>(i);
  throw Error(ErrorKind::scene, "", "unknown event kind \"" + name + "\" in a trajectory");
}

}  // namespace cradle
