#pragma once

#include <map>
#include <string>

namespace cradle {

/// The shaders of the folder shaders/ by file name, as they were when the program was built.
const std::map<std::string, std::string>& embeddedShaders();

}  // namespace cradle
