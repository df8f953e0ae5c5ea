#version 330 core

// A square of the map of contact shadows around each thing that may darken the ground.

layout(location = 0) in vec2 corner;         // -1..1
layout(location = 2) in vec4 boxFromWorldX;  // rows: from a point relative to the setup's origin into the box's frame
layout(location = 3) in vec4 boxFromWorldY;
layout(location = 4) in vec4 boxFromWorldZ;
layout(location = 5) in vec4 halfAndReach;   // m; half edges, and how far the darkening goes beyond
layout(location = 6) in vec4 centreAndKind;  // centre in clip coordinates of the map; w: 0 box, 1 ellipsoid, 2 cylinder
layout(location = 7) in vec4 halfSize;       // half size in clip coordinates of the map

uniform vec3 mapOrigin;  // m; corner of the map
uniform vec3 mapU;       // m; its whole edges
uniform vec3 mapV;

flat out vec4 rowX;
flat out vec4 rowY;
flat out vec4 rowZ;
flat out vec4 box;
flat out float kind;
out vec3 position;

void main() {
  vec2 place = centreAndKind.xy + corner * halfSize.xy;
  rowX = boxFromWorldX;
  rowY = boxFromWorldY;
  rowZ = boxFromWorldZ;
  box = halfAndReach;
  kind = centreAndKind.w;
  position = mapOrigin + (0.5 + 0.5 * place.x) * mapU + (0.5 + 0.5 * place.y) * mapV;
  gl_Position = vec4(place, 0.0, 1.0);
}
