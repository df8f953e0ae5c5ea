// Balls near a surface: they are mirrored in it, and keep the sky's light from it.

uniform samplerBuffer ballTexels;      // two a ball: centre and radius; linear colour and metallic
uniform samplerBuffer nearBallTexels;  // indices of the balls near each item, one after the other

const float kBallReach = 3.0;  // radii: what is farther from a ball's centre does not show it, and changes with nothing there

// Share of the hemisphere around `normal` that a ball leaves open (exact while it is wholly above the surface).
float openSky(vec3 to, float radius, vec3 normal) {
  float squared = max(dot(to, to), radius * radius);
  return 1.0 - max(dot(to, normal) * inversesqrt(squared), 0.0) * radius * radius / squared;
}

// What a ray meets first.
struct Mirrored {
  vec3 from;       // where the ray goes on: from the ball that it met, or from where it started
  vec3 direction;
  vec3 normal;     // of the ball
  vec4 look;       // of the ball: linear colour, metallic
  float coverage;  // 1 on the ball, 0 beside it, between where the ray is wider than its edge
};

// Looks at the balls near a surface once: for what a ray from it meets, and for the sky that they leave open (returned).
// A ray that grazes a ball goes straight on, so that the surroundings have no seam at a ball's edge.
float lookAtBalls(int first, int count, vec3 position, vec3 normal, float spread, inout Mirrored ray) {
  float open = 1.0;
  float nearest = 1e30;
  vec3 from = ray.from, direction = ray.direction;
  for (int i = 0; i < count; ++i) {
    int index = int(texelFetch(nearBallTexels, first + i).r);
    vec4 ball = texelFetch(ballTexels, 2 * index);
    vec3 to = ball.xyz - position;
    if (dot(to, to) >= kBallReach * kBallReach * ball.w * ball.w) continue;
    float near = 1.0 - smoothstep(kBallReach - 1.0, kBallReach, length(to) / ball.w);
    open *= mix(1.0, openSky(to, ball.w, normal), near);
    float along = dot(to, direction);
    vec3 aside = along * direction - to;
    float beside = length(aside);
    float soft = spread * max(along, 0.0) + 1e-3 * ball.w;
    float covered = along > 0.0 ? near * clamp(0.5 + (ball.w - beside) / soft, 0.0, 1.0) : 0.0;
    if (covered > 0.0 && along < nearest) {
      nearest = along;
      ray.coverage = covered;
      vec3 outwards = aside - sqrt(max(ball.w * ball.w - beside * beside, 0.0)) * direction;
      ray.normal = outwards / max(length(outwards), 1e-6 * ball.w);
      ray.from = ball.xyz + outwards;
      ray.look = texelFetch(ballTexels, 2 * index + 1);
    }
  }
  ray.direction = reflect(direction, ray.normal);
  return open;
}
