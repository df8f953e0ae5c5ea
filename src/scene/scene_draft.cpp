#include "scene/scene_draft.h"

#include "scene/suggestion.h"

namespace cradle {
namespace {

std::string hintFor(const std::string& name, const std::map<std::string, int>& index, const FaultList& faults) {
  if (faults.isFull()) return "";
  if (index.empty()) return "; there are none";
  if (index.contains(name + "_0")) return "; copies are named " + inQuotes(name + "_0") + " and so on";
  std::vector<std::string> names;
  for (const auto& [known, unused] : index) names.push_back(known);
  return didYouMean(name, names);
}

}  // namespace

std::optional<int> findNamed(const Field& field, const std::map<std::string, int>& index, const char* noun,
                             FaultList& faults) {
  const auto name = readText(field, faults);
  if (!name) return std::nullopt;
  if (const auto found = index.find(*name); found != index.end()) return found->second;
  addFault(faults, field, std::string("there is no ") + noun + " " + inQuotes(*name) + hintFor(*name, index, faults));
  return std::nullopt;
}

}  // namespace cradle
