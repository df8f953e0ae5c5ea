// From scene light to the bytes of the picture.

const float kShoulder = 0.5;  // below, light is shown as it is; above, it bends towards white and never clips

vec3 toneCurve(vec3 light) {
  vec3 above = max(light - kShoulder, 0.0);
  return min(light, kShoulder) + (1.0 - kShoulder) * (1.0 - exp(-above / (1.0 - kShoulder)));
}

// IEC 61966-2-1.
vec3 srgbFromLinear(vec3 c) {
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThan(c, vec3(0.0031308)));
}

vec3 encode(vec3 light) {
  return srgbFromLinear(toneCurve(light));
}

// A fixed pattern between -0.5 and 0.5 that leaves no bands in slow gradients: interleaved gradient noise
// (J. Jimenez, "Next generation post processing in Call of Duty: Advanced Warfare", 2014).
float ditherPattern(vec2 pixel) {
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
}
