// How much of the key light arrives: depths of the shadow map compared over a patch of texels, weighted by a tent, so
// that edges are soft and do not step. Four texels come with each gather.

uniform sampler2D shadowMap;
uniform mat4 shadowFromWorld;  // to texture coordinates and depth, 0..1
uniform float shadowSize;      // texels a side
uniform float shadowTexel;     // m, world size of a texel

vec4 litTexels(vec2 corner, float depth) {
  return step(vec4(min(depth, 1.0)), textureGather(shadowMap, corner / shadowSize));
}

// Weights of texels -2..3 around a point at `f` between texels 0 and 1: a tent of half-width 3, of sum 9.
void tentWeights(float f, out vec2 low, out vec2 middle, out vec2 high) {
  low = vec2(1.0 - f, 2.0 - f);
  middle = vec2(3.0 - f, 2.0 + f);
  high = vec2(1.0 + f, f);
}

// `w` are the weights of the left and right, `h` of the lower and upper texels.
float weigh(vec4 lit, vec2 w, vec2 h) {
  return dot(lit, vec4(w.x * h.y, w.y * h.y, w.y * h.x, w.x * h.x));
}

float softShadow(vec3 position) {
  vec3 place = (shadowFromWorld * vec4(position, 1.0)).xyz;
  vec2 texel = place.xy * shadowSize - 0.5;
  vec2 base = floor(texel) + 1.0;  // the corner between the four nearest texels
  vec2 f = texel - floor(texel);
  vec2 wl, wm, wh, hl, hm, hh;
  tentWeights(f.x, wl, wm, wh);
  tentWeights(f.y, hl, hm, hh);
  float lit = weigh(litTexels(base + vec2(-2.0, -2.0), place.z), wl, hl);
  lit += weigh(litTexels(base + vec2(0.0, -2.0), place.z), wm, hl);
  lit += weigh(litTexels(base + vec2(2.0, -2.0), place.z), wh, hl);
  lit += weigh(litTexels(base + vec2(-2.0, 0.0), place.z), wl, hm);
  lit += weigh(litTexels(base + vec2(0.0, 0.0), place.z), wm, hm);
  lit += weigh(litTexels(base + vec2(2.0, 0.0), place.z), wh, hm);
  lit += weigh(litTexels(base + vec2(-2.0, 2.0), place.z), wl, hh);
  lit += weigh(litTexels(base + vec2(0.0, 2.0), place.z), wm, hh);
  lit += weigh(litTexels(base + vec2(2.0, 2.0), place.z), wh, hh);
  return lit / 81.0;
}

// The same from four texels: enough for what mirrors show.
float quickShadow(vec3 position) {
  vec3 place = (shadowFromWorld * vec4(position, 1.0)).xyz;
  vec2 texel = place.xy * shadowSize - 0.5;
  vec2 f = texel - floor(texel);
  return weigh(litTexels(floor(texel) + 1.0, place.z), vec2(1.0 - f.x, f.x), vec2(1.0 - f.y, f.y));
}
