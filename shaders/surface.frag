#version 330 core
#extension GL_ARB_texture_gather : require
#define MIRRORS_SHADOWS
#include "surface.glsl"

in vec3 position;
in vec3 normal;
in float coverage;
#if PATTERNS
in vec3 bodyPosition;
#endif
#if TEXTURES
in vec2 coordinates;
uniform sampler2D colorMap;
#endif

out vec4 color;

void main() {
#if PATTERNS
  bodyPlace = bodyPosition;
#endif
#if TEXTURES
  texel = texture(colorMap, coordinates).rgb;
#endif
  vec3 n = normalize(gl_FrontFacing ? normal : -normal);
  color = vec4(encode(shade(position, n)), sampleShare(coverage));
}
