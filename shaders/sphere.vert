#version 330 core

// The half of a sphere that the viewer sees, as a few triangles with an exact outline.

uniform mat4 clipFromWorld;
uniform vec4 viewer;  // m; w = 0: infinitely far in that direction

layout(location = 0) in vec3 place;           // angle from the axis to the viewer, 1 at the outline; direction around it
layout(location = 2) in vec4 centerAndRadius;    // m
layout(location = 3) in vec4 worldFromBody;      // a quaternion, w last; of a pattern
layout(location = 5) in vec4 instanceRoughness;  // w; linear colour of the pattern
layout(location = 6) in vec4 instanceColor;      // linear; w is metallic
layout(location = 7) in vec4 instanceOccluders;  // first and number of the occluders near; 1 if it mirrors shadows, and twice the kind of pattern; its cell, m

flat out vec4 sphere;
flat out vec4 surfaceColor;
flat out float roughness;
flat out vec2 nearOccluders;
flat out float mirrorsShadows;
#if PATTERNS
flat out vec4 bodyTurn;
flat out vec4 pattern;
flat out float patternKind;
#endif

const float kRightAngle = 1.57079633;

void main() {
  vec3 center = centerAndRadius.xyz;
  float radius = centerAndRadius.w;
  vec3 towards = viewer.xyz - viewer.w * center;
  float distance = length(towards);
  vec3 axis = towards / distance;
  vec3 u = normalize(cross(axis, abs(axis.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  vec3 v = cross(axis, u);
  float outline = viewer.w > 0.0 ? acos(min(radius / distance, 1.0)) : kRightAngle;
  float angle = place.x * outline;
  vec3 position = center + radius * (cos(angle) * axis + sin(angle) * (place.y * u + place.z * v));
  sphere = centerAndRadius;
  surfaceColor = instanceColor;
  roughness = instanceRoughness.w;
  nearOccluders = instanceOccluders.xy;
  mirrorsShadows = mod(instanceOccluders.z, 2.0);
#if PATTERNS
  pattern = vec4(instanceRoughness.xyz, instanceOccluders.w);
  patternKind = floor(0.5 * instanceOccluders.z);
  bodyTurn = worldFromBody;
#endif
  gl_Position = clipFromWorld * vec4(position, 1.0);
}
