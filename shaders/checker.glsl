// A ground of squares, averaged exactly over the footprint of a pixel so that it neither flickers nor shows moire.

uniform vec4 groundPlane;      // unit normal, distance from the origin along it (m)
uniform vec3 groundAxisU;      // unit, in the plane
uniform vec3 groundAxisV;
uniform float checkPhaseU;     // position of the origin within the pattern, in squares
uniform float checkPhaseV;
uniform float checksPerMetre;
uniform vec3 lightCheck;
uniform vec3 darkCheck;
uniform float fadeDistance;    // m, where the ground has dissolved into the horizon to 63 %

// Integral of the square wave that is +1 on [0,1) and -1 on [1,2).
vec2 squareWaveIntegral(vec2 x) {
  return abs(2.0 * fract(0.5 * x + 0.5) - 1.0);
}

// Colour at `place` (squares), averaged over a box of size `footprint` (squares).
vec3 checkColor(vec2 place, vec2 footprint) {
  vec2 width = max(footprint, vec2(1e-4));
  vec2 mean = (squareWaveIntegral(place + 0.5 * width) - squareWaveIntegral(place - 0.5 * width)) / width;
  mean *= 1.0 - smoothstep(0.5, 1.0, width);  // squares of a pixel or less would beat with the pixels
  return mix(darkCheck, lightCheck, 0.5 + 0.5 * mean.x * mean.y);
}

vec2 checkPlace(vec3 position) {
  return checksPerMetre * vec2(dot(position, groundAxisU), dot(position, groundAxisV)) +
         vec2(checkPhaseU, checkPhaseV);
}

float groundFade(float distance) {
  float x = distance / fadeDistance;
  return 1.0 - exp(-x * x);
}
