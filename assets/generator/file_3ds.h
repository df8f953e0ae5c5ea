#pragma once

#include "surface.h"

namespace cradle::assets {

/// The bytes of a 3ds file with `model` in it, z up as the format wants it (x, y, z of the model become x, -z, y).
std::string encode3ds(const Model& model);

}  // namespace cradle::assets
