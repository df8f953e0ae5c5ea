// How much of the sky bodies leave open above a point of the ground.

uniform sampler2D contactShadowMap;    // share of the sky's light that bodies keep from the ground
uniform vec4 contactShadowFromWorldU;  // world to texture coordinates: dot(xyz, position) + w
uniform vec4 contactShadowFromWorldV;

float contactShadow(vec3 position) {
  vec2 place = vec2(dot(contactShadowFromWorldU.xyz, position) + contactShadowFromWorldU.w,
                    dot(contactShadowFromWorldV.xyz, position) + contactShadowFromWorldV.w);
  return 1.0 - texture(contactShadowMap, place).r;
}
