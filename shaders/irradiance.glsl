// Light on the ground: from the key light, and from the sky as far as bodies near the ground leave it open.

vec3 groundIrradiance(float lit, float open) {
  return lightRadiance * (max(dot(groundPlane.xyz, lightDirection), 0.0) * lit) + skyIrradiance * open;
}
