#version 330 core

// The half of a cylinder's side that the viewer sees, and the end that it sees, as a few triangles with an exact outline.

uniform mat4 clipFromWorld;
uniform vec4 viewer;  // m; w = 0: infinitely far in that direction
uniform float pixelSize;  // m, of a pixel at a depth of 1 m; 0 for the shadow map

layout(location = 0) in vec3 place;  // side: -1 or 1 for the ends, share of the visible angle -1..1, 0; end: cos, sin, 1
layout(location = 2) in vec4 centerAndRadius;    // m
layout(location = 3) in vec4 axisAndLength;      // unit; m
layout(location = 4) in vec4 side;               // unit, across the axis; of a pattern
layout(location = 5) in vec4 instanceRoughness;  // w; linear colour of the pattern
layout(location = 6) in vec4 instanceColor;      // linear; w is metallic
layout(location = 7) in vec4 instanceOccluders;  // first and number of the occluders near; twice the kind of pattern; its cell, m

flat out vec4 base;  // centre, radius
flat out vec4 axis;  // unit; 0 on the side, +-1 on an end
flat out float halfLength;
out float drawnRadius;
out float coverage;
flat out vec4 surfaceColor;
flat out float roughness;
flat out vec2 nearOccluders;
#if PATTERNS
flat out vec3 bodySide;
flat out vec4 pattern;
flat out float patternKind;
#endif

const float kRightAngle = 1.57079633;
const float kThinnest = 0.55;  // pixels: radius of the thinnest line that is drawn; thinner ones fade

void main() {
  vec3 center = centerAndRadius.xyz, along = axisAndLength.xyz;
  halfLength = 0.5 * axisAndLength.w;
  vec3 towards = viewer.xyz - viewer.w * center;
  float height = dot(towards, along);
  vec3 across = towards - height * along;
  float distance = length(across);
  vec3 front = distance > 1e-6 * abs(height) ? across / distance
                                             : normalize(cross(along, abs(along.y) < 0.9 ? vec3(0.0, 1.0, 0.0)
                                                                                         : vec3(1.0, 0.0, 0.0)));
  vec3 right = cross(along, front);

  bool isEnd = place.z > 0.5;
  float end = isEnd ? sign(height) : place.x;
  drawnRadius = max(centerAndRadius.w, kThinnest * pixelSize * (clipFromWorld * vec4(center + end * halfLength * along, 1.0)).w);
  coverage = centerAndRadius.w / drawnRadius;
  float radius = drawnRadius;
  float outline = viewer.w > 0.0 ? acos(min(radius / max(distance, 1e-20), 1.0)) : kRightAngle;
  float angle = place.y * outline;
  vec3 outwards = isEnd ? place.x * front + end * place.y * right : cos(angle) * front + sin(angle) * right;
  // From within its length, no end is seen: its triangles shrink to nothing.
  bool hidden = isEnd && abs(height) <= viewer.w * halfLength;
  vec3 position = center + (end * halfLength) * along + (hidden ? 0.0 : radius) * outwards;

  base = centerAndRadius;
  axis = vec4(along, isEnd ? end : 0.0);
  surfaceColor = instanceColor;
  roughness = instanceRoughness.w;
  nearOccluders = instanceOccluders.xy;
#if PATTERNS
  pattern = vec4(instanceRoughness.xyz, instanceOccluders.w);
  patternKind = floor(0.5 * instanceOccluders.z);
  bodySide = side.xyz;
#endif
  gl_Position = clipFromWorld * vec4(position, 1.0);
}
