// A ground with lines at decimal distances over hardly visible squares, averaged exactly over the footprint of a pixel
// so that it neither flickers nor shows moire.

uniform vec4 groundPlane;      // unit normal, distance from the origin along it (m)
uniform vec3 groundAxisU;      // unit, in the plane
uniform vec3 groundAxisV;
uniform float gridPhaseU;      // position of the origin within the pattern, in squares
uniform float gridPhaseV;
uniform float squaresPerMetre;
uniform vec3 lightSquare;
uniform vec3 darkSquare;
uniform vec3 lineShade;        // of lines each tenth of a square, each square, each ten squares: share of the ground's colour
uniform float fadeDistance;    // m, where the ground has dissolved into the horizon to 63 %

const vec3 kLineWidth = vec3(0.006, 0.015, 0.024);  // squares
const float kFinestFade = 0.03;  // lines disappear while their distance shrinks from so many pixels (inverse)
const float kFinestGone = 0.14;  // to so many

// Integral of the square wave that is +1 on [0,1) and -1 on [1,2).
vec2 squareWaveIntegral(vec2 x) {
  return abs(2.0 * fract(0.5 * x + 0.5) - 1.0);
}

// Share of a box of size `footprint` around `place` that lines of `width` at all whole numbers cover.
float lineShare(vec2 place, vec2 footprint, float width) {
  vec2 beside = place - floor(place + 0.5);
  vec2 low = beside - 0.5 * footprint, high = beside + 0.5 * footprint;
  vec2 lowLine = floor(low + 0.5), highLine = floor(high + 0.5);
  vec2 covered = (highLine - lowLine) * width + clamp(high - highLine, -0.5 * width, 0.5 * width) -
                 clamp(low - lowLine, -0.5 * width, 0.5 * width);
  vec2 open = 1.0 - covered / footprint;
  return 1.0 - open.x * open.y;
}

// Lines at distances of `spacing` squares.
float lineFactor(vec2 place, vec2 footprint, float spacing, float width, float shade) {
  vec2 relative = max(footprint / spacing, vec2(1e-5));
  float seen = 1.0 - smoothstep(kFinestFade, kFinestGone, max(relative.x, relative.y));
  return mix(1.0, shade, seen * lineShare(place / spacing, relative, width / spacing));
}

// Colour at `place` (squares), averaged over a box of size `footprint` (squares).
vec3 gridColor(vec2 place, vec2 footprint) {
  vec2 width = max(footprint, vec2(1e-4));
  vec2 mean = (squareWaveIntegral(place + 0.5 * width) - squareWaveIntegral(place - 0.5 * width)) / width;
  mean *= 1.0 - smoothstep(0.5, 1.0, width);  // squares of a pixel or less would beat with the pixels
  vec3 color = mix(darkSquare, lightSquare, 0.5 + 0.5 * mean.x * mean.y);
  color *= lineFactor(place, footprint, 0.1, kLineWidth.x, lineShade.x);
  color *= lineFactor(place, footprint, 1.0, kLineWidth.y, lineShade.y);
  return color * lineFactor(place, footprint, 10.0, kLineWidth.z, lineShade.z);
}

vec2 gridPlace(vec3 position) {
  return squaresPerMetre * vec2(dot(position, groundAxisU), dot(position, groundAxisV)) +
         vec2(gridPhaseU, gridPhaseV);
}

float groundFade(float distance) {
  float x = distance / fadeDistance;
  return 1.0 - exp(-x * x);
}
