// The direction in which a pixel looks, not normalised.

uniform vec3 cornerRay;  // through the lower left corner of the picture
uniform vec3 columnRay;  // from one column to the next
uniform vec3 rowRay;     // from one row to the next, upwards

vec3 pixelRay(vec2 pixel) {
  return cornerRay + pixel.x * columnRay + pixel.y * rowRay;
}
