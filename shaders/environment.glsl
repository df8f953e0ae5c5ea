// What a ray meets that leaves a surface: the ground with its lines and shadows, else the sky.

uniform vec3 skyIrradiance;     // of the open sky, as a radiance from white
uniform vec3 skySlope;          // relative change of the surroundings' light with the direction of a surface
uniform vec3 bounceIrradiance;  // what the ground or the floor sends back up

#if HAS_GROUND
#include "grid.glsl"
#include "irradiance.glsl"
#ifdef MIRRORS_SHADOWS  // only shining spheres do: all others may stay as they are when a shadow moves
#include "contact_shadow.glsl"
flat in float mirrorsShadows;
#endif

const float kBlurredTexels = 12.0;  // footprint in texels of the shadow map from which no shadow shows
const float kUsuallyLit = 0.85;  // share of the ground out of shadow, where a mirror shows too much of it at once

vec3 groundLight(vec3 from, vec3 direction, float spread, float bounced) {
  float approach = min(dot(groundPlane.xyz, direction), -1e-3);
  float t = max((groundPlane.w - dot(groundPlane.xyz, from)) / approach, 0.0);
  vec3 position = from + t * direction;
  vec2 place = gridPlace(position);
  vec2 footprint = fwidth(place) + squaresPerMetre * spread * t;
  vec3 albedo = gridColor(place, footprint);
  float lit = kUsuallyLit, open = 1.0;
#ifdef MIRRORS_SHADOWS
  if (mirrorsShadows > 0.5) {
    // Shadows much smaller than the footprint would only flicker.
    float texels = max(footprint.x, footprint.y) / (squaresPerMetre * shadowTexel);
    float blur = max(smoothstep(2.0, kBlurredTexels, texels), bounced);
    lit = mix(quickShadow(position), kUsuallyLit, blur);
    open = mix(contactShadow(position), 1.0, blur);
  }
#endif
  vec3 light = albedo * groundIrradiance(lit, open);
  return mix(light, horizonColor, groundFade(t));
}

#endif

// `spread` is how far the ray fans out per metre; `bounced` 1 if it comes by way of a sphere: it shows no shadows then.
vec3 environment(vec3 from, vec3 direction, float spread, float bounced) {
  vec3 sky = skyLight(direction) + skyGlow(direction);
#if HAS_GROUND
  float height = dot(groundPlane.xyz, direction);
  return mix(groundLight(from, direction, spread, bounced), sky, smoothstep(-spread - 0.01, spread + 0.01, height));
#else
  return sky;
#endif
}

const float kBounceSlope = 2.0;  // on the side away from the key light, the ground lies in shadow

// Light from all around on a matt surface: sky from above, from below what the ground or the floor sends back; more from
// the side of the key light, where skies are brighter.
vec3 ambientLight(vec3 normal) {
  float aside = dot(skySlope, normal);
  return mix(bounceIrradiance * (1.0 + kBounceSlope * aside), skyIrradiance * (1.0 + aside), 0.5 + 0.5 * normal.y);
}
