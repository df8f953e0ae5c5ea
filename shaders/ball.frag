#version 330 core
#extension GL_ARB_texture_gather : require
#define MIRRORS_SHADOWS
#include "surface.glsl"
#include "ray.glsl"

// The triangles only say where a ball is seen; its surface is met exactly by the ray through the pixel.

flat in vec4 ball;  // centre, radius

out vec4 color;

void main() {
  vec3 ray = normalize(pixelRay(gl_FragCoord.xy));
  vec3 to = ball.xyz - eye;
  float along = dot(to, ray);
  vec3 aside = along * ray - to;
  // At the edge, the pixel's centre may miss the ball: the ray then grazes it.
  vec3 outwards = aside - sqrt(max(ball.w * ball.w - dot(aside, aside), 0.0)) * ray;
  vec3 n = normalize(outwards);
  color = vec4(encode(shade(ball.xyz + ball.w * n, n)), 1.0);
}
