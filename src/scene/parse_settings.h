#pragma once

#include <optional>
#include <string>

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// All of the scene file that is about the scene as a whole: from `schema` to `output` and `lights`.
void parseSettings(ObjectReader& root, Scene& scene);

/// That a run would have more frames than can be counted, or more steps than anyone would wait for; none if neither.
std::optional<std::string> frameCountFault(const Scene& scene);
std::optional<std::string> stepCountFault(const Scene& scene);

}  // namespace cradle
