// Light that comes from the sky, or from the walls of a studio where there is no ground.

uniform vec3 lightDirection;  // unit, towards the key light
uniform vec3 lightRadiance;   // what a white matt surface facing the key light sends out
uniform vec3 zenithColor;
uniform vec3 horizonColor;
uniform vec3 nadirColor;      // seen only where there is no ground

const float kHorizonSharpness = 5.0;  // half of the haze is gone 11 degrees above the horizon

vec3 skyLight(vec3 direction) {
  float x = kHorizonSharpness * direction.y;
  return mix(direction.y > 0.0 ? zenithColor : nadirColor, horizonColor, 1.0 / (1.0 + x * x));
}

// What mirrors see besides: a bright haze around the key light.
vec3 skyGlow(vec3 direction) {
  float towards = max(dot(direction, lightDirection), 0.0);
  float t2 = towards * towards;
  float t8 = t2 * t2 * t2 * t2;
  return lightRadiance * (0.10 * t2 * t2 + 0.35 * t8 * t8 * t8 * t8);
}
