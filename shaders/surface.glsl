// How a surface looks: what the vertex shader says of it, and the light that it sends to the eye.

#include "encode.glsl"
#include "sky.glsl"
#include "shadow.glsl"
#include "environment.glsl"
#include "occluders.glsl"

uniform vec3 eye;
#if FILL_LIGHTS > 0  // lights after the first throw no shadow
uniform vec3 fillDirection[FILL_LIGHTS];  // unit, towards the light
uniform vec3 fillRadiance[FILL_LIGHTS];
#endif

flat in vec4 surfaceColor;  // linear; w is metallic
flat in float roughness;
flat in vec2 nearOccluders;
#if PATTERNS
flat in vec4 pattern;  // linear colour; w is the size of a cell, m
flat in float patternKind;

vec3 bodyPlace;  // of what is shaded, in the body's frame: main() says it

// -1 and 1 in turn from whole number to whole number of x, and what lies between where a pixel has more than one.
float alternating(float x) {
  float wave = abs(mod(x + 0.5, 2.0) - 1.0) - 0.5;
  return clamp(2.0 * wave / max(fwidth(x), 1e-6), -1.0, 1.0);
}

vec3 painted(vec3 base) {
  // A little inside, and aside: faces lie where cells end.
  vec3 place = 0.999 * bodyPlace / pattern.w + 0.002;
  float share = 0.0;
  if (patternKind < 1.5) {
    share = alternating(place.x);
  } else if (patternKind < 2.5) {
    share = alternating(place.x) * alternating(place.y) * alternating(place.z);
  } else {
    float across = max(length(place.xz), 1e-6);
    float sine = place.z / across, sixth = sine * (3.0 - 4.0 * sine * sine);  // six sectors around the y axis
    share = clamp(2.0 * sixth / max(fwidth(sixth), 1e-6), -1.0, 1.0);
    share = mix(share, 1.0, clamp((0.5 - across) / max(fwidth(across), 1e-6) + 0.5, 0.0, 1.0));  // and two caps
  }
  return mix(base, pattern.rgb, 0.5 + 0.5 * share);
}
#endif

vec3 texel = vec3(1.0);  // linear, of the texture: main() says it

const float kDielectric = 0.04;   // reflected straight on by plastic, wood, stone
const float kSheen = 0.08;         // the same of what is seen in a mirror, at the usual slant
const float kLightWidth = 0.035;  // the lights are no points: the narrowest highlight
const float kFromOccluders = 0.2;  // occluders send out light too: a fraction of that of the surroundings
const float kTexelsAside = 1.5;   // so far a surface stands off from its own depths, which are those of flat triangles

// Microfacets of Walter, Marschner, Li, Torrance 2007 (GGX); visibility term of Heitz 2014 in Hammon's approximation,
// both without the factor pi that the radiance of the light has been given.
vec3 highlight(vec3 n, vec3 v, vec3 l, vec3 straightOn, float alpha) {
  vec3 h = normalize(l + v);
  float nl = max(dot(n, l), 0.0), nv = abs(dot(n, v)) + 1e-4, nh = max(dot(n, h), 0.0), vh = max(dot(v, h), 0.0);
  float a2 = alpha * alpha;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float visibility = 0.5 / mix(2.0 * nl * nv, nl + nv, alpha);
  vec3 fresnel = straightOn + (1.0 - straightOn) * pow(1.0 - vh, 5.0);
  return fresnel * (a2 / (d * d) * visibility * nl);
}

// Share of the surroundings that a rough surface mirrors (B. Karis, "Physically based shading on mobile", 2014).
vec3 mirroredShare(vec3 straightOn, float roughness, float nv) {
  vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
  return straightOn * (r.z - 1.04 * a) + (r.w + 1.04 * a);
}

float keyShadow(vec3 position, vec3 n) {
  float facing = dot(n, lightDirection);
  float lit = 0.0;
  if (facing > 0.0) {
    float aside = kTexelsAside * shadowTexel * sqrt(max(1.0 - facing * facing, 0.0));
    lit = softShadow(position + n * aside, n);
  }
  return lit;
}

// What alpha tells of a line thinner than a pixel: the number of its samples is rounded up from there, four to a pixel.
float sampleShare(float coverage) {
  return coverage < 1.0 ? max(coverage - 0.125, 0.01) : 1.0;
}

// Light from `position` on a surface with unit normal `n` towards the eye.
vec3 shade(vec3 position, vec3 n) {
  vec3 v = normalize(eye - position);
  float metallic = surfaceColor.w;
  vec3 base = surfaceColor.rgb * texel;
#if PATTERNS
  if (patternKind > 0.5) base = painted(base);
#endif
  vec3 matt = base * (1.0 - metallic);
  vec3 straightOn = mix(vec3(kDielectric), base, metallic);
  float turn = length(fwidth(n));  // thin things turn within a pixel
  float alpha = min(roughness * roughness + kLightWidth + 0.3 * turn, 1.0 + kLightWidth);
  int first = int(nearOccluders.x), count = int(nearOccluders.y);

  float spread = roughness * roughness + 2.0 * turn;
  Mirrored ray = Mirrored(position, reflect(-v, n), vec3(0.0), vec4(1.0), 0.0);
  float open = mix(kFromOccluders, 1.0, gatherOccluders(first, count, position, n, spread, ray));

  vec3 key = lightRadiance * keyShadow(position, n);
  vec3 light = key * (matt * max(dot(n, lightDirection), 0.0) + highlight(n, v, lightDirection, straightOn, alpha));
#if FILL_LIGHTS > 0
  for (int i = 0; i < FILL_LIGHTS; ++i)
    light += fillRadiance[i] *
             (matt * max(dot(n, fillDirection[i]), 0.0) + highlight(n, v, fillDirection[i], straightOn, alpha));
#endif

  vec3 mirrored = environment(ray.from, ray.direction, spread, ray.coverage) * mix(vec3(1.0), ray.look.rgb, ray.coverage);
  vec3 mattSphere = ray.look.rgb * (ambientLight(ray.normal) + lightRadiance * max(dot(ray.normal, lightDirection), 0.0));
  mattSphere += kSheen * skyLight(ray.direction);
  mirrored = mix(mirrored, mattSphere, ray.coverage * (1.0 - ray.look.w));
  light += open * matt * ambientLight(n) + mirroredShare(straightOn, roughness, abs(dot(n, v))) * mirrored *
           mix(1.0, open, roughness);
  return light;
}
