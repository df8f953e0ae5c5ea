#version 330 core

// A mesh placed in the world, many at a time.

uniform mat4 clipFromWorld;

layout(location = 0) in vec3 meshPosition;
layout(location = 1) in vec3 meshNormal;
layout(location = 2) in vec4 worldFromMeshX;  // rows of the rigid transform
layout(location = 3) in vec4 worldFromMeshY;
layout(location = 4) in vec4 worldFromMeshZ;
layout(location = 5) in vec4 instanceRoughness;  // w; linear colour of the pattern
layout(location = 6) in vec4 instanceColor;      // linear; w is metallic
layout(location = 7) in vec4 instanceOccluders;  // first and number of the occluders near; 1 if it mirrors shadows, and twice the kind of pattern; its cell, m

#if TEXTURES
layout(location = 8) in vec2 meshCoordinates;  // on the texture; rows from the top
#endif

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

void main() {
  vec4 place = vec4(meshPosition, 1.0);
  position = vec3(dot(worldFromMeshX, place), dot(worldFromMeshY, place), dot(worldFromMeshZ, place));
  normal = vec3(dot(worldFromMeshX.xyz, meshNormal), dot(worldFromMeshY.xyz, meshNormal),
                dot(worldFromMeshZ.xyz, meshNormal));
  surfaceColor = instanceColor;
  roughness = instanceRoughness.w;
  nearOccluders = instanceOccluders.xy;
  mirrorsShadows = mod(instanceOccluders.z, 2.0);
#if PATTERNS
  pattern = vec4(instanceRoughness.xyz, instanceOccluders.w);
  patternKind = floor(0.5 * instanceOccluders.z);
  bodyPosition = meshPosition;
#endif
#if TEXTURES
  coordinates = meshCoordinates;
#endif
  coverage = 1.0;
  gl_Position = clipFromWorld * vec4(position, 1.0);
}
