#pragma once

#include <map>
#include <string>

namespace cradle {

/// What a page of a motion is made of, by the names of the files: those of player/, and three.js.
const std::map<std::string, std::string>& embeddedPlayer();

}  // namespace cradle
