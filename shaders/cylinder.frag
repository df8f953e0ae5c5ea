#version 330 core
#extension GL_ARB_texture_gather : require
#include "surface.glsl"
#include "ray.glsl"

// The triangles only say where a cylinder is seen; its surface is met exactly by the ray through the pixel.

flat in vec4 base;  // centre, radius
flat in vec4 axis;  // unit; 0 on the side, +-1 on an end
flat in float halfLength;
in float drawnRadius;
in float coverage;
#if PATTERNS
flat in vec3 bodySide;  // unit, across the axis
#endif

out vec4 color;

void main() {
  vec3 ray = normalize(pixelRay(gl_FragCoord.xy));
  vec3 from = eye - base.xyz;
  vec3 rayAcross = ray - dot(ray, axis.xyz) * axis.xyz;
  vec3 fromAcross = from - dot(from, axis.xyz) * axis.xyz;
  float a = max(dot(rayAcross, rayAcross), 1e-12);
  float b = dot(rayAcross, fromAcross);
  float c = dot(fromAcross, fromAcross) - drawnRadius * drawnRadius;
  // At the edge, the pixel's centre may miss the cylinder: the ray then grazes it.
  float t = (-b - sqrt(max(b * b - a * c, 0.0))) / a;
  vec3 n = normalize(fromAcross + t * rayAcross);
  if (axis.w != 0.0) {
    n = axis.w * axis.xyz;
    t = (halfLength - dot(from, n)) / min(dot(ray, n), -1e-6);
  }
#if PATTERNS
  vec3 fromCenter = from + t * ray;
  bodyPlace = vec3(dot(fromCenter, bodySide), dot(fromCenter, axis.xyz), dot(fromCenter, cross(bodySide, axis.xyz)));
#endif
  color = vec4(encode(shade(eye + t * ray, n)), sampleShare(coverage));
}
