// How much of the sky bodies leave open above a point of the ground.

uniform sampler2D contactMap;    // share of the sky's light that bodies keep from the ground
uniform vec4 contactFromWorldU;  // world to texture coordinates: dot(xyz, position) + w
uniform vec4 contactFromWorldV;

float contactShade(vec3 position) {
  vec2 place = vec2(dot(contactFromWorldU.xyz, position) + contactFromWorldU.w,
                    dot(contactFromWorldV.xyz, position) + contactFromWorldV.w);
  return 1.0 - texture(contactMap, place).r;
}
