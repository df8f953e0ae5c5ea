#version 330 core

// A round tube along a curve: a coil around the line between two points, or a line that sags.

uniform mat4 clipFromWorld;

layout(location = 0) in vec3 place;         // along the curve 0..1, cosine and sine of the angle around it
layout(location = 2) in vec4 startAndWire;  // m; w is the radius of the tube
layout(location = 3) in vec4 endAndCoil;    // m; w is the radius of the coil
layout(location = 4) in vec4 sideAndTurns;  // unit, across the line; w is the number of turns
layout(location = 5) in vec4 sagAndRoughness;
layout(location = 6) in vec4 instanceColor;
layout(location = 7) in vec4 instanceOccluders;  // z: share of a coil that is straight at each end, or a rope's slack; w: its lean

uniform float pixelSize;  // m, of a pixel at a depth of 1 m; 0 for the shadow map

out vec3 position;
out vec3 normal;
flat out vec4 surfaceColor;
flat out float roughness;
flat out vec2 nearOccluders;
flat out float mirrorsShadows;
out float coverage;
#if TEXTURES
out vec2 coordinates;
#endif
#if PATTERNS
out vec3 bodyPosition;
flat out vec4 pattern;
flat out float patternKind;
#endif

const float kTurn = 6.28318531;
const float kThinnest = 0.55;  // pixels: radius of the thinnest line that is drawn; thinner ones fade

float turned(float s) {
  float straight = instanceOccluders.z;
  return clamp((s - straight) / (1.0 - 2.0 * straight), 0.0, 1.0);
}

vec3 outwards(float s, vec3 side, vec3 across) {
  float angle = kTurn * sideAndTurns.w * turned(s);
  return cos(angle) * side + sin(angle) * across;
}

// How far a rope hangs below its chord, in terms of the middle, at a share s along the chord (tube_curve.cpp).
float hanging(float s, float slack, float lean) {
  float u = 2.0 * s - 1.0, middle = sinh(0.5 * slack);
  return (sinh(0.5 * slack * (1.0 + u)) * sinh(0.5 * slack * (1.0 - u)) +
          0.5 * lean * (u * sinh(slack) - sinh(slack * u))) /
         (middle * middle);
}

// Share along the chord at a share `s` along the rope.
float alongChord(float s, float slack, float lean) {
  float shift = 0.5 * log((1.0 + lean) / (1.0 - lean));
  float place = mix(sinh(shift - slack), sinh(shift + slack), s);
  float turn = sign(place) * log(abs(place) + sqrt(place * place + 1.0));
  return clamp(0.5 + 0.5 * (turn - shift) / slack, 0.0, 1.0);
}

// The coil grows out of the straight ends and shrinks back within as much of the length again.
vec3 curve(float s, vec3 line, vec3 side, vec3 across) {
  if (sideAndTurns.w == 0.0) {
    float slack = instanceOccluders.z, lean = instanceOccluders.w;
    if (slack == 0.0) return startAndWire.xyz + s * line;
    float along = alongChord(clamp(s, 0.0, 1.0), slack, lean);
    return startAndWire.xyz + along * line + hanging(along, slack, lean) * sagAndRoughness.xyz;
  }
  float inside = turned(s);
  float open = smoothstep(0.0, 1.0, min(inside, 1.0 - inside) / max(instanceOccluders.z, 1e-3));
  return startAndWire.xyz + s * line + endAndCoil.w * open * outwards(s, side, across);
}

void main() {
  vec3 line = endAndCoil.xyz - startAndWire.xyz;
  vec3 side = sideAndTurns.xyz;
  vec3 across = cross(normalize(line), side);
  vec3 centre = curve(place.x, line, side, across);
  const float kStep = 1e-3;
  vec3 tangent = normalize(curve(place.x + kStep, line, side, across) - curve(place.x - kStep, line, side, across));
  // Rings start outwards from the line: that turns slowly along the curve and never lies along it.
  vec3 radial = outwards(place.x, side, across);
  vec3 u = normalize(radial - dot(radial, tangent) * tangent);
  vec3 v = cross(tangent, u);
  normal = place.y * u + place.z * v;
  float thinnest = kThinnest * pixelSize * (clipFromWorld * vec4(centre, 1.0)).w;
  float radius = max(startAndWire.w, thinnest);
  coverage = startAndWire.w / radius;
  position = centre + radius * normal;
  surfaceColor = instanceColor;
  roughness = sagAndRoughness.w;
  nearOccluders = instanceOccluders.xy;
#if PATTERNS
  bodyPosition = vec3(0.0);
  pattern = vec4(0.0);
  patternKind = 0.0;
#endif
#if TEXTURES
  coordinates = vec2(0.0);
#endif
  mirrorsShadows = 0.0;
  gl_Position = clipFromWorld * vec4(position, 1.0);
}
