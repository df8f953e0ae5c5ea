#version 330 core

// A round tube along a curve: a coil around the line between two points, or a line that sags.

uniform mat4 clipFromWorld;

layout(location = 0) in vec3 place;         // along the curve 0..1, cosine and sine of the angle around it
layout(location = 2) in vec4 startAndWire;  // m; w is the radius of the tube
layout(location = 3) in vec4 endAndCoil;    // m; w is the radius of the coil
layout(location = 4) in vec4 sideAndTurns;  // unit, across the line; w is the number of turns
layout(location = 5) in vec4 sagAndRoughness;
layout(location = 6) in vec4 instanceColor;
layout(location = 7) in vec4 instanceBalls;  // z: share of the length that is straight at each end

out vec3 position;
out vec3 normal;
flat out vec4 surfaceColor;
flat out float roughness;
flat out vec2 nearBalls;
flat out float mirrorsShadows;

const float kTurn = 6.28318531;

float turned(float s) {
  float straight = instanceBalls.z;
  return clamp((s - straight) / (1.0 - 2.0 * straight), 0.0, 1.0);
}

vec3 outwards(float s, vec3 side, vec3 across) {
  float angle = kTurn * sideAndTurns.w * turned(s);
  return cos(angle) * side + sin(angle) * across;
}

// The coil grows out of the straight ends and shrinks back within as much of the length again.
vec3 curve(float s, vec3 line, vec3 side, vec3 across) {
  float inside = turned(s);
  float open = smoothstep(0.0, 1.0, min(inside, 1.0 - inside) / max(instanceBalls.z, 1e-3));
  return startAndWire.xyz + s * line + endAndCoil.w * open * outwards(s, side, across) +
         4.0 * s * (1.0 - s) * sagAndRoughness.xyz;
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
  position = centre + startAndWire.w * normal;
  surfaceColor = instanceColor;
  roughness = sagAndRoughness.w;
  nearBalls = instanceBalls.xy;
  mirrorsShadows = 0.0;
  gl_Position = clipFromWorld * vec4(position, 1.0);
}
