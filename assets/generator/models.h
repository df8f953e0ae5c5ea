#pragma once

#include "surface.h"

namespace cradle::assets {

/// Every model that the folder assets/ holds.
std::vector<Model> allModels();

}  // namespace cradle::assets
