#version 330 core
#include "encode.glsl"
#include "ray.glsl"
#include "sky.glsl"

out vec4 color;

void main() {
  vec3 light = skyLight(normalize(pixelRay(gl_FragCoord.xy)));
  color = vec4(encodeSmoothly(light, gl_FragCoord.xy), 1.0);
}
