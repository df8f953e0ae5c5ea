#version 330 core
#include "ground.glsl"

// The ground around, which no shadow reaches: most of the picture, and half the work a pixel.

out vec4 color;

void main() { color = groundColor(meetGround(), 1.0, 1.0); }
