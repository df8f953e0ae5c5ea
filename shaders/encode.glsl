// From scene light to the bytes of the picture.

// The fit of K. Narkowicz, "ACES filmic tone mapping curve", 2016: a toe that keeps shadows dark, a shoulder that bends
// lights towards white and never clips them.
vec3 toneCurve(vec3 light) {
  return min(light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14), 1.0);
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

// For what fills large parts of the picture and changes slowly over it.
vec3 encodeSmoothly(vec3 light, vec2 pixel) {
  return encode(light) + ditherPattern(pixel) / 255.0;
}
