#version 330 core
#extension GL_ARB_texture_gather : require
#define MIRRORS_SHADOWS
#include "surface.glsl"
#include "ray.glsl"

// The triangles only say where a sphere is seen; its surface is met exactly by the ray through the pixel.

flat in vec4 sphere;  // centre, radius

out vec4 color;

void main() {
  vec3 ray = normalize(pixelRay(gl_FragCoord.xy));
  vec3 to = sphere.xyz - eye;
  float along = dot(to, ray);
  vec3 aside = along * ray - to;
  // At the edge, the pixel's centre may miss the sphere: the ray then grazes it.
  vec3 outwards = aside - sqrt(max(sphere.w * sphere.w - dot(aside, aside), 0.0)) * ray;
  vec3 n = normalize(outwards);
  color = vec4(encode(shade(sphere.xyz + sphere.w * n, n)), 1.0);
}
