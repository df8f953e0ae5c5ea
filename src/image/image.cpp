#include "image/image.h"

#include "core/error.h"

namespace cradle {

Image::Image(int imageWidth, int imageHeight) : width(imageWidth), height(imageHeight) {
  CRADLE_CHECK(width >= 0 && height >= 0);
  pixels.resize(offset(0, height));
}

}  // namespace cradle
