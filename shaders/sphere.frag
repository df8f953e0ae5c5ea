#version 330 core
#extension GL_ARB_texture_gather : require
#define MIRRORS_SHADOWS
#include "surface.glsl"
#include "ray.glsl"

// The triangles only say where a sphere is seen; its surface is met exactly by the ray through the pixel.

flat in vec4 sphere;  // centre, radius

#if PATTERNS
flat in vec4 bodyTurn;  // worldFromBody as a quaternion, w last
#endif

out vec4 color;

void main() {
  vec3 ray = normalize(pixelRay(gl_FragCoord.xy));
  vec3 to = sphere.xyz - eye;
  float along = dot(to, ray);
  vec3 aside = along * ray - to;
  // At the edge, the pixel's centre may miss the sphere: the ray then grazes it.
  vec3 outwards = aside - sqrt(max(sphere.w * sphere.w - dot(aside, aside), 0.0)) * ray;
  vec3 n = normalize(outwards);
#if PATTERNS
  vec3 t = 2.0 * cross(n, bodyTurn.xyz);  // turned back
  bodyPlace = sphere.w * (n + bodyTurn.w * t + cross(t, bodyTurn.xyz));
#endif
  color = vec4(encode(shade(sphere.xyz + sphere.w * n, n)), 1.0);
}
