#version 330 core
#extension GL_ARB_texture_gather : require

// Least depth of a block of the shadow map.

uniform sampler2D shadowMap;
uniform float shadowSize;  // texels a side

out float least;

const int kBlock = 8;  // as in render_setup.h

void main() {
  vec2 corner = floor(gl_FragCoord.xy) * float(kBlock);
  vec4 depths = vec4(1.0);
  for (int row = 1; row < kBlock; row += 2)
    for (int column = 1; column < kBlock; column += 2)
      depths = min(depths, textureGather(shadowMap, (corner + vec2(column, row)) / shadowSize));
  least = min(min(depths.x, depths.y), min(depths.z, depths.w));
}
