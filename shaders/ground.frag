#version 330 core
#extension GL_ARB_texture_gather : require
#include "ground.glsl"
#include "shadow.glsl"
#include "contact_shadow.glsl"

// The ground near the scene, where shadows fall.

out vec4 color;

void main() {
  GroundPoint point = meetGround();
  vec3 position = groundPosition(point);
  color = groundColor(point, softShadow(position, groundPlane.xyz), contactShadow(position));
}
