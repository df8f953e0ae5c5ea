// Spheres and boxes near a surface: they are mirrored in it, and keep the sky's light from it.

uniform samplerBuffer occluderTexels;      // four each: centre and radius; linear colour and metallic; half edges, 1 for a box; turn
uniform samplerBuffer nearOccluderTexels;  // indices of those near each item, one after the other

const float kSphereReach = 3.0;  // radii: what is farther from a sphere's centre does not show it, and changes with nothing there

struct Occluder {
  vec4 place;  // centre; radius of a sphere, reach of a box beyond its surface (m)
  vec4 look;   // linear colour, metallic
  vec4 box;    // half edges, 1 for a box
  vec4 turn;   // quaternion, world from box
};

// What a ray meets first.
struct Mirrored {
  vec3 from;       // where the ray goes on: from what it met, or from where it started
  vec3 direction;
  vec3 normal;     // of what it met
  vec4 look;       // of it: linear colour, metallic
  float coverage;  // 1 on it, 0 beside it, between where the ray is wider than its edge
};

vec3 turnedBy(vec4 q, vec3 v) {
  return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

const float kTouching = 0.03;  // half widths of a box: nearer, all of it counts as a wall, whatever rounding says of its side

// Share of the hemisphere around `normal` that a sphere leaves open (exact while it is wholly above the surface).
float openBesideSphere(vec3 to, float radius, vec3 normal) {
  float squared = max(dot(to, to), radius * radius);
  return 1.0 - max(dot(to, normal) * inversesqrt(squared), 0.0) * radius * radius / squared;
}

// The same for a box, from its nearest point `to` at distance d: between a wall of height h, which hides
// (1 - d / sqrt(d^2 + h^2)) / 2 as far as it is wide, and a ceiling of half-width w, which hides w^2 / (w^2 + d^2).
float openBesideBox(vec3 to, float height, float width, vec3 normal) {
  float d = length(to);
  float above = dot(to, normal) / (d + kTouching * width);
  float wall = 0.5 * (1.0 - d * inversesqrt(d * d + height * height + 1e-20)) * width / (width + 0.5 * d);
  float ceiling = width * width / (width * width + d * d);
  float rising = smoothstep(0.0, 0.1 * width, height);
  return 1.0 - rising * mix(wall, ceiling, clamp(above, 0.0, 1.0)) * smoothstep(-1.0, 0.0, above);
}

void meetSphere(Occluder sphere, float along, vec3 aside, float beside, inout Mirrored ray) {
  vec3 outwards = aside - sqrt(max(sphere.place.w * sphere.place.w - beside * beside, 0.0)) * ray.direction;
  ray.normal = outwards / max(length(outwards), 1e-6 * sphere.place.w);
  ray.from = sphere.place.xyz + outwards;
  ray.look = sphere.look;
}

// Visits the occluders of a surface once: for what a ray from it meets, and for the sky that they leave open
// (returned). A ray that grazes one goes straight on, so that the surroundings have no seam at its edge.
float gatherOccluders(int first, int count, vec3 position, vec3 normal, float spread, inout Mirrored ray) {
  float open = 1.0;
  float nearest = 1e30;
  vec3 start = ray.from;
  for (int i = 0; i < count; ++i) {
    int index = 4 * int(texelFetch(nearOccluderTexels, first + i).r);
    Occluder item = Occluder(texelFetch(occluderTexels, index), texelFetch(occluderTexels, index + 1),
                               texelFetch(occluderTexels, index + 2), texelFetch(occluderTexels, index + 3));
    vec3 to = item.place.xyz - position;
    if (item.box.w == 0.0) {
      if (dot(to, to) >= kSphereReach * kSphereReach * item.place.w * item.place.w) continue;
      float near = 1.0 - smoothstep(kSphereReach - 1.0, kSphereReach, length(to) / item.place.w);
      open *= mix(1.0, openBesideSphere(to, item.place.w, normal), near);
      float along = dot(to, ray.direction);
      vec3 aside = along * ray.direction - to;
      float beside = length(aside);
      float soft = spread * max(along, 0.0) + 1e-3 * item.place.w;
      float covered = along > 0.0 ? near * clamp(0.5 + (item.place.w - beside) / soft, 0.0, 1.0) : 0.0;
      if (covered > 0.0 && along < nearest) {
        nearest = along;
        ray.coverage = covered;
        meetSphere(item, along, aside, beside, ray);
      }
      continue;
    }
    vec4 back = vec4(-item.turn.xyz, item.turn.w);
    vec3 place = turnedBy(back, -to), up = turnedBy(back, normal), direction = turnedBy(back, ray.direction);
    vec3 extent = item.box.xyz;
    vec3 toNearest = clamp(place, -extent, extent) - place;
    float distance = length(toNearest);
    if (distance >= item.place.w) continue;
    float near = 1.0 - smoothstep(0.5, 1.0, distance / item.place.w);
    float width = item.place.w / 1.6;  // the middle half edge: kBoxReach of draw_list.h
    open *= mix(1.0, openBesideBox(toNearest, dot(abs(up), extent) - dot(place, up), width, up), near);
    vec3 steps = 1.0 / (direction + mix(vec3(-1e-7), vec3(1e-7), greaterThanEqual(direction, vec3(0.0))));
    vec3 enter = -place * steps - extent * abs(steps), leave = -place * steps + extent * abs(steps);
    float t = max(max(enter.x, enter.y), enter.z), end = min(min(leave.x, leave.y), leave.z);
    float least = min(extent.x, min(extent.y, extent.z));
    float covered = t > -1e-3 * least ? near * clamp((end - t) / (2.0 * spread * max(t, 0.0) + 0.02 * least), 0.0, 1.0) : 0.0;
    if (covered > 0.0 && t < nearest) {
      nearest = t;
      ray.coverage = covered;
      vec3 face = -sign(direction) * step(vec3(t), enter);
      ray.normal = turnedBy(item.turn, normalize(face));
      ray.from = start + t * ray.direction;
      ray.look = item.look;
    }
  }
  ray.direction = reflect(ray.direction, ray.normal);
  return open;
}
