#include "overlay/overlay_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "scene/fault_list.h"
#include "scene/suggestion.h"

namespace cradle {
namespace {

constexpr std::string_view kHeightPlot = "plot=height:";

constexpr std::size_t kMaxNames = 12;  // that a message lists

[[noreturn]] void refuse(const std::string& word, const std::string& why) {
  throw Error(ErrorKind::usage, "--overlay", fmt::format("found \"{}\"; {}", word, why));
}

void read(const std::string& word, OverlayChoice& choice) {
  const auto plot = [&](PlotKind kind) {
    if (choice.plot) refuse(word, "there is one plot in a picture, and another was named before");
    choice.plot = kind;
  };
  if (word == "time")
    choice.time = true;
  else if (word == "contacts")
    choice.contacts = true;
  else if (word == "velocities")
    choice.velocities = true;
  else if (word == "trails")
    choice.trails = true;
  else if (word == "plot=energy")
    plot(PlotKind::energy);
  else if (word == "plot=energyError")
    plot(PlotKind::energyError);
  else if (word.starts_with(kHeightPlot))
    plot(PlotKind::height), choice.plottedBody = word.substr(kHeightPlot.size());
  else
    refuse(word,
           "allowed are time, contacts, velocities, trails, plot=energy, plot=energyError and plot=height:BODY, with "
           "commas between them");
}

/// "; allowed are "ball1", "ball2"; did you mean "ball1"?"
std::string allowedBodies(const OverlayChoice& choice, const Scene& scene) {
  std::vector<std::string> names, quoted;
  for (const Body& body : scene.bodies)
    if (body.motion != Motion::fixed) names.push_back(body.name);
  for (const std::string& name : names)
    if (quoted.size() < kMaxNames) quoted.push_back(inQuotes(name));
  if (quoted.empty()) return "; the scene has none that moves";
  const std::string others = names.size() > kMaxNames ? fmt::format(" and {} more", names.size() - kMaxNames) : "";
  return fmt::format("; allowed are {}{}{}", fmt::join(quoted, ", "), others, didYouMean(choice.plottedBody, names));
}

}  // namespace

OverlayChoice parseOverlays(const std::string& text) {
  OverlayChoice choice;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    read(text.substr(start, end - start), choice);
    start = end + 1;
  }
  return choice;
}

int plottedBody(const OverlayChoice& choice, const Scene& scene) {
  const std::string word = std::string(kHeightPlot) + choice.plottedBody;
  const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                 [&](const Body& candidate) { return candidate.name == choice.plottedBody; });
  if (body == scene.bodies.end()) refuse(word, "there is no body of that name" + allowedBodies(choice, scene));
  if (body->motion == Motion::fixed) refuse(word, "that body is static" + allowedBodies(choice, scene));
  return static_cast<int>(body - scene.bodies.begin());
}

}  // namespace cradle
