#pragma once

#include "image/image.h"
#include "surface.h"

namespace cradle::assets {

/// A die whose faces are pieces of diePicture(): 1, 2 and 3 meet at a corner, counter-clockwise; opposite faces are 7.
Surface die();

/// The faces 1 to 3 above 4 to 6.
Image diePicture();

}  // namespace cradle::assets
