// How much of the key light arrives. The light is a disc: the farther the thing that hides it, the softer the shadow's
// edge (R. Fernando, "Percentage-closer soft shadows", 2005). Least depths of blocks of the shadow map tell whether
// anything stands in the cone to the light, and how far; then depths are compared over as wide a disc of the map.
// The surface's own plane is followed in both, so that it hides nothing from itself (J. Isidoro, "Shadow mapping:
// GPU-based tips and techniques", 2006). Lengths are in texels, depths too.

uniform sampler2D shadowMap;
uniform sampler2D shadowBlocks;  // least depth of each block
uniform mat4 shadowFromWorld;    // to texture coordinates and depth, 0..1
uniform float shadowSize;        // texels a side
uniform float shadowDeep;        // depth of the map in texels
uniform float shadowTexel;       // m, world size of a texel

const float kBlock = 8.0;          // as in render_setup.h
const float kLightRadius = 0.03;   // tangent of half the angle in which the light is seen; as in changed_area.cpp
const float kWidestRadius = 16.0;  // of the disc
const float kNarrowestRadius = 1.3;
const int kSamplePairs = 12;
const float kDepthBias = 0.6;
const float kSteepest = 12.0;  // slope of a surface's plane in the map; beyond, hardly any light arrives

// Texels in the order of textureGather, from the corner between them.
const vec4 kGatherX = vec4(-0.5, 0.5, 0.5, -0.5);
const vec4 kGatherY = vec4(0.5, 0.5, -0.5, -0.5);

float weigh(vec4 lit, vec2 f) {
  return mix(mix(lit.w, lit.z, f.x), mix(lit.x, lit.y, f.x), f.y);
}

// Sums over blocks that stand in the cone towards the light: weights, and distances times weights. `corner` is in
// blocks, `place` and `slope` are the surface's.
vec2 blockersAround(vec2 corner, vec3 place, vec2 slope) {
  vec4 x = kBlock * (corner.x + kGatherX) - place.x, y = kBlock * (corner.y + kGatherY) - place.y;
  vec4 depth = shadowDeep * textureGather(shadowBlocks, corner * kBlock / shadowSize);
  // Nowhere in the block is the surface's plane nearer to the light than this.
  float lowest = place.z - 0.5 * kBlock * (abs(slope.x) + abs(slope.y)) - kDepthBias;
  vec4 away = min(lowest + slope.x * x + slope.y * y, place.z) - depth;
  vec4 besideX = max(abs(x) - 0.5 * kBlock, 0.0), besideY = max(abs(y) - 0.5 * kBlock, 0.0);
  vec4 cone = min(kLightRadius * max(away, 0.0), kWidestRadius) + 0.5 * kBlock;
  vec4 weight = step(1e-3, away) * (1.0 - step(shadowDeep, depth)) * max(1.0 - sqrt(besideX * besideX + besideY * besideY) / cone, 0.0);
  return vec2(dot(weight, vec4(1.0)), dot(weight, max(away, 0.0)));
}

// Share of the four texels around `texel`, by distance, that is not nearer to the light than the surface's plane.
float litAround(vec2 texel, vec3 place, vec2 slope, vec4 ownPlane) {
  vec2 corner = floor(texel + 0.5);
  vec4 depth = shadowDeep * textureGather(shadowMap, corner / shadowSize);
  // What is behind the surface hides nothing, in a corner either; nor does what is beyond the map.
  float farthest = min(place.z, shadowDeep + kDepthBias);
  vec4 plane = min(place.z + dot(slope, corner - place.xy) + ownPlane, farthest) - kDepthBias;
  return weigh(step(plane, depth), texel + 0.5 - corner);
}

// The same of a disc: pairs of samples, so that no shadow is moved to a side.
float litDisc(vec3 place, vec2 slope, float radius) {
  const float kTurn = 2.39996323;  // the golden angle: samples spread evenly over the disc (H. Vogel, 1979)
  const mat2 kTurning = mat2(cos(kTurn), sin(kTurn), -sin(kTurn), cos(kTurn));
  vec4 ownPlane = slope.x * kGatherX + slope.y * kGatherY;
  vec2 direction = vec2(1.0, 0.0);
  float lit = 0.0;
  for (int i = 0; i < kSamplePairs; ++i) {
    vec2 aside = radius * sqrt((float(i) + 0.5) / float(kSamplePairs)) * direction;
    lit += litAround(place.xy + aside, place, slope, ownPlane) + litAround(place.xy - aside, place, slope, ownPlane);
    direction = kTurning * direction;
  }
  return lit / float(2 * kSamplePairs);
}

float softShadow(vec3 position, vec3 normal) {
  vec3 scale = vec3(shadowSize, shadowSize, shadowDeep);
  vec3 place = (shadowFromWorld * vec4(position, 1.0)).xyz * scale;
  vec3 turned = (shadowFromWorld * vec4(normal, 0.0)).xyz * scale;
  vec2 slope = clamp(turned.xy / max(-turned.z, 1e-6), -kSteepest, kSteepest);
  vec2 corner = floor(place.xy / kBlock + 0.5);
  vec2 blockers = vec2(0.0);
  for (int row = -2; row <= 2; row += 2)
    for (int column = -2; column <= 2; column += 2)
      blockers += blockersAround(corner + vec2(column, row), place, slope);
  float lit = 1.0;
  if (blockers.x > 0.0) {
    float radius = clamp(kLightRadius * blockers.y / blockers.x, kNarrowestRadius, kWidestRadius);
    lit = litDisc(place, slope, radius);
  }
  return lit;
}

// The same from four texels: enough for what mirrors show.
float quickShadow(vec3 position) {
  vec3 place = (shadowFromWorld * vec4(position, 1.0)).xyz;
  vec2 texel = place.xy * shadowSize;
  vec2 corner = floor(texel + 0.5);
  vec4 depth = textureGather(shadowMap, corner / shadowSize);
  return weigh(step(vec4(min(place.z, 1.0) - 2.0 / shadowDeep), depth), texel + 0.5 - corner);
}
