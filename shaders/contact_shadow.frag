#version 330 core

// Share of the sky's light that something near keeps from a point of the ground.

uniform vec4 groundPlane;

flat in vec4 rowX;
flat in vec4 rowY;
flat in vec4 rowZ;
flat in vec4 box;
flat in float kind;  // 0 box, 1 ellipsoid in it, 2 cylinder in it
in vec3 position;

out vec4 share;

// A sphere above the ground hides (r/d)^2 cos of the angle to the vertical, exactly; an ellipsoid, in coordinates that
// make it a sphere, nearly so.
float hiddenByEllipsoid(vec3 place, vec3 up, vec3 halfAxes) {
  vec3 to = -place / halfAxes;
  float squared = max(dot(to, to), 1.0);
  return clamp(dot(to, normalize(up * halfAxes)) * inversesqrt(squared), 0.0, 1.0) / squared;
}

// A long wall of height H hides (1 - d / sqrt(d^2 + H^2)) / 2 at distance d, a ceiling twice that: between the two by
// the direction of the nearest point of a box or cylinder.
float hiddenBySolid(vec3 place, vec3 nearest, vec3 up, vec3 halfEdges) {
  vec3 to = nearest - place;
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
  vec3 nearest = clamp(place, -box.xyz, box.xyz);
  if (kind > 1.5) nearest.xz = place.xz * min(1.0, box.x / max(length(place.xz), 1e-6 * box.x));
  float hidden = kind == 1.0 ? hiddenByEllipsoid(place, up, box.xyz) : hiddenBySolid(place, nearest, up, box.xyz);
  // Nothing ends abruptly at the border of the square.
  float beyond = length(place - clamp(place, -box.xyz, box.xyz)) / box.w;
  share = vec4(hidden * (1.0 - smoothstep(0.5, 1.0, beyond)));
}
