#version 330 core
#include "encode.glsl"
#include "ray.glsl"
#include "sky.glsl"

out vec4 color;

void main() {
  vec3 light = skyLight(normalize(pixelRay(gl_FragCoord.xy)));
  color = vec4(encode(light) + ditherPattern(gl_FragCoord.xy) / 255.0, 1.0);
}
