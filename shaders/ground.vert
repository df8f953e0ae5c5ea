#version 330 core

uniform mat4 clipFromWorld;

layout(location = 0) in vec4 corner;  // w = 0: infinitely far in that direction

void main() {
  gl_Position = clipFromWorld * corner;
}
