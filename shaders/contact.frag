#version 330 core

// Share of the sky's light that a ball or a box keeps from a point of the ground.

uniform vec4 groundPlane;

flat in vec4 rowX;
flat in vec4 rowY;
flat in vec4 rowZ;
flat in vec4 box;
flat in float isBall;
in vec3 position;

out vec4 share;

// A ball above the ground hides (r/d)^2 cos of the angle to the vertical, exactly.
float hiddenByBall(vec3 place, vec3 up, float radius) {
  float squared = max(dot(place, place), radius * radius);
  return clamp(-dot(place, up) * inversesqrt(squared), 0.0, 1.0) * radius * radius / squared;
}

// A long wall of height H hides (1 - d / sqrt(d^2 + H^2)) / 2 at distance d, a ceiling twice that: between the two by
// the direction of the box's nearest point.
float hiddenByBox(vec3 place, vec3 up, vec3 halfEdges) {
  vec3 to = clamp(place, -halfEdges, halfEdges) - place;
  float d = length(to);
  float height = 2.0 * min(halfEdges.x, min(halfEdges.y, halfEdges.z));
  float above = d > 0.0 ? clamp(dot(to, up) / d, 0.0, 1.0) : 1.0;
  return (1.0 - d / sqrt(d * d + height * height)) * (0.5 + 0.5 * above);
}

void main() {
  vec4 p = vec4(position, 1.0);
  vec3 place = vec3(dot(rowX, p), dot(rowY, p), dot(rowZ, p));
  vec3 n = groundPlane.xyz;
  vec3 up = vec3(dot(rowX.xyz, n), dot(rowY.xyz, n), dot(rowZ.xyz, n));
  float hidden = isBall > 0.5 ? hiddenByBall(place, up, box.x) : hiddenByBox(place, up, box.xyz);
  // Nothing ends abruptly at the border of the square.
  float beyond = length(place - clamp(place, -box.xyz, box.xyz)) / box.w;
  share = vec4(hidden * (1.0 - smoothstep(0.5, 1.0, beyond)));
}
