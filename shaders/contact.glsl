// Light that reaches the ground: the key light, and the sky as far as bodies near the ground leave it open.

uniform sampler2D contactMap;   // share of the sky's light that bodies keep from the ground
uniform vec4 contactFromWorldU; // world to texture coordinates: dot(xyz, position) + w
uniform vec4 contactFromWorldV;
uniform vec3 skyIrradiance;     // of the open sky on the ground, as a radiance from white

float contactShade(vec3 position) {
  vec2 place = vec2(dot(contactFromWorldU.xyz, position) + contactFromWorldU.w,
                    dot(contactFromWorldV.xyz, position) + contactFromWorldV.w);
  return 1.0 - texture(contactMap, place).r;
}

vec3 groundIrradiance(float lit, float open) {
  return lightRadiance * (max(dot(groundPlane.xyz, lightDirection), 0.0) * lit) + skyIrradiance * open;
}
