// The ground where the ray through a pixel meets it.

#include "encode.glsl"
#include "ray.glsl"
#include "sky.glsl"
#include "grid.glsl"

uniform vec3 skyIrradiance;  // of the open sky, as a radiance from white
#include "irradiance.glsl"

uniform vec3 eye;

struct GroundPoint {
  vec3 ray;        // from the eye, not normalised
  float reach;     // in lengths of the ray
  float approach;  // of the ray to the plane, < 0
};

GroundPoint meetGround() {
  vec3 ray = pixelRay(gl_FragCoord.xy);
  // Edge samples of a pixel whose centre is above the horizon see the ground infinitely far.
  float approach = min(dot(groundPlane.xyz, ray), -1e-6);
  return GroundPoint(ray, (groundPlane.w - dot(groundPlane.xyz, eye)) / approach, approach);
}

vec3 groundPosition(GroundPoint point) {
  return eye + point.reach * point.ray;
}

// How the position changes to a neighbouring pixel, whose ray differs by `step`; in squares.
vec2 footprintAlong(GroundPoint point, vec3 step) {
  vec3 change = point.reach * (step - point.ray * (dot(groundPlane.xyz, step) / point.approach));
  return squaresPerMetre * abs(vec2(dot(change, groundAxisU), dot(change, groundAxisV)));
}

vec4 groundColor(GroundPoint point, float lit, float open) {
  vec2 footprint = footprintAlong(point, columnRay) + footprintAlong(point, rowRay);
  vec3 light = gridColor(gridPlace(groundPosition(point)), footprint) * groundIrradiance(lit, open);
  float distance = point.reach * length(point.ray);
  vec3 horizon = skyLight(vec3(point.ray.x, max(point.ray.y, 0.0), point.ray.z) / length(point.ray));
  return vec4(encodeSmoothly(mix(light, horizon, groundFade(distance)), gl_FragCoord.xy), 1.0);
}
