#version 330 core
#extension GL_ARB_texture_gather : require
#include "encode.glsl"
#include "ray.glsl"
#include "sky.glsl"
#include "shadow.glsl"
#include "checker.glsl"
#include "contact.glsl"

uniform vec3 eye;

out vec4 color;

void main() {
  vec3 ray = pixelRay(gl_FragCoord.xy);
  // Edge samples of a pixel whose centre is above the horizon see the ground infinitely far.
  float approach = min(dot(groundPlane.xyz, ray), -1e-6);
  float t = (groundPlane.w - dot(groundPlane.xyz, eye)) / approach;
  vec3 position = eye + t * ray;

  vec3 alongRow = t * (columnRay - ray * (dot(groundPlane.xyz, columnRay) / approach));
  vec3 alongColumn = t * (rowRay - ray * (dot(groundPlane.xyz, rowRay) / approach));
  vec2 footprint = checksPerMetre * (abs(vec2(dot(alongRow, groundAxisU), dot(alongRow, groundAxisV))) +
                                     abs(vec2(dot(alongColumn, groundAxisU), dot(alongColumn, groundAxisV))));

  vec3 albedo = checkColor(checkPlace(position), footprint);
  vec3 light = albedo * groundIrradiance(softShadow(position), contactShade(position));
  vec3 direction = normalize(ray);
  light = mix(light, skyLight(vec3(direction.x, max(direction.y, 0.0), direction.z)), groundFade(t * length(ray)));
  color = vec4(encode(light), 1.0);
}
