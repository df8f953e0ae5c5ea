#include "mesh/primitives.h"

#include <numbers>

#include "core/error.h"
#include "math/elementary.h"

namespace cradle {
namespace {

using std::numbers::pi;

MassProperties centred(double mass, const Vec3& principalInertia) {
  return {mass, Vec3::Zero(), principalInertia.asDiagonal()};
}

// A circle of vertices around y, all with the same height and the same slope of the surface.
struct Ring {
  double radius, height;                // m
  double radialNormal, heightOfNormal;  // of the unit normal
};

void addRing(const Ring& ring, int segments, DrawnMesh& mesh) {
  for (int s = 0; s < segments; ++s) {
    const double angle = 2 * pi * s / segments;  // from z towards x, so that rising rings wind outwards
    const auto [x, z] = sinCos(angle);
    mesh.vertices.emplace_back(ring.radius * x, ring.height, ring.radius * z);
    mesh.normals.push_back(
        Vec3(ring.radialNormal * x, ring.heightOfNormal, ring.radialNormal * z).normalized().cast<float>());
  }
}

void addPoint(double height, double heightOfNormal, DrawnMesh& mesh) {
  mesh.vertices.emplace_back(0, height, 0);
  mesh.normals.emplace_back(0, static_cast<float>(heightOfNormal), 0);
}

// A surface of revolution: bottom point, rings from bottom to top, top point.
void addRevolution(const std::vector<Ring>& rings, double bottom, double top, int segments, DrawnMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(segments);
  auto below = static_cast<std::uint32_t>(mesh.vertices.size());
  addPoint(bottom, -1, mesh);
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    addRing(rings[r], segments, mesh);
    for (std::uint32_t s = 0; s < count; ++s) {
      const std::uint32_t next = (s + 1) % count;
      if (r == 0) {
        mesh.triangles.push_back({below, first + next, first + s});
      } else {
        mesh.triangles.push_back({below + s, below + next, first + next});
        mesh.triangles.push_back({below + s, first + next, first + s});
      }
    }
    below = first;
  }
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size());
  addPoint(top, 1, mesh);
  for (std::uint32_t s = 0; s < count; ++s) mesh.triangles.push_back({below + s, below + (s + 1) % count, last});
}

// Rings of a half sphere around (0, centre, 0), from angle `from` to `to` above the equator, ends included.
void appendArc(double radius, double centre, double from, double to, int steps, std::vector<Ring>& rings) {
  for (int i = 0; i <= steps; ++i) {
    const double angle = from + (to - from) * i / steps;
    const auto [sine, cosine] = sinCos(angle);
    rings.push_back({radius * cosine, centre + radius * sine, cosine, sine});
  }
}

DrawnMesh oneMaterial(DrawnMesh mesh) {
  ModelMaterial material;
  material.triangleCount = static_cast<std::uint32_t>(mesh.triangles.size());
  mesh.materials = {material};
  return mesh;
}

}  // namespace

MassProperties massProperties(const Sphere& sphere, double density) {
  const double r = sphere.radius;
  const double mass = density * 4 / 3 * pi * r * r * r;
  return centred(mass, Vec3::Constant(0.4 * mass * r * r));
}

MassProperties massProperties(const Box& box, double density) {
  const double mass = density * box.size.prod();
  const Vec3 squares = box.size.cwiseAbs2();
  return centred(mass, mass / 12 * (Vec3::Constant(squares.sum()) - squares));
}

MassProperties massProperties(const Cylinder& cylinder, double density) {
  const double r = cylinder.radius, l = cylinder.length;
  const double mass = density * pi * r * r * l;
  const double across = mass * (3 * r * r + l * l) / 12;
  return centred(mass, Vec3(across, mass * r * r / 2, across));
}

MassProperties massProperties(const Capsule& capsule, double density) {
  const double r = capsule.radius, l = capsule.length;
  const double middle = density * pi * r * r * l;
  const double caps = density * 4 / 3 * pi * r * r * r;  // both
  // A half sphere's centre of mass is 3/8 r above its base; 2/5 m r^2 about the base's centre is moved there and out.
  const double capsAcross = caps * (0.4 * r * r + l * l / 4 + 3.0 / 8 * l * r);
  const double across = middle * (3 * r * r + l * l) / 12 + capsAcross;
  return centred(middle + caps, Vec3(across, middle * r * r / 2 + 0.4 * caps * r * r, across));
}

MassProperties shellProperties(const Sphere& sphere, double surfaceDensity) {
  const double squared = sphere.radius * sphere.radius, mass = surfaceDensity * 4 * pi * squared;
  return centred(mass, Vec3::Constant(2.0 / 3 * mass * squared));
}

// Two plates across each axis: m (b^2 + c^2) / 12 about it, and m c^2 / 12 + m a^2 / 4 about the others.
MassProperties shellProperties(const Box& box, double surfaceDensity) {
  double mass = 0;
  Vec3 moments = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    const double a = box.size[axis], b = box.size[next], c = box.size[last], plates = 2 * surfaceDensity * b * c;
    mass += plates;
    moments[axis] += plates * (b * b + c * c) / 12;
    moments[next] += plates * (c * c / 12 + a * a / 4);
    moments[last] += plates * (b * b / 12 + a * a / 4);
  }
  return centred(mass, moments);
}

MassProperties shellProperties(const Cylinder& cylinder, double surfaceDensity) {
  const double r = cylinder.radius, l = cylinder.length;
  const double side = surfaceDensity * 2 * pi * r * l, ends = surfaceDensity * 2 * pi * r * r;  // both
  const double across = side * (r * r / 2 + l * l / 12) + ends * (r * r + l * l) / 4;
  return centred(side + ends, Vec3(across, side * r * r + ends * r * r / 2, across));
}

MassProperties shellProperties(const Capsule& capsule, double surfaceDensity) {
  const double r = capsule.radius, l = capsule.length;
  const double side = surfaceDensity * 2 * pi * r * l, caps = surfaceDensity * 4 * pi * r * r;  // both
  // Half a sphere's centre of mass is r / 2 above its base; 2/3 m r^2 about the base's centre is moved there and out.
  const double across = side * (r * r / 2 + l * l / 12) + caps * (2.0 / 3 * r * r + l * l / 4 + l * r / 2);
  return centred(side + caps, Vec3(across, side * r * r + 2.0 / 3 * caps * r * r, across));
}

DrawnMesh tessellate(const Sphere& sphere, int segments) {
  CRADLE_CHECK(segments >= 6);
  const int rows = segments / 2;
  std::vector<Ring> rings;
  appendArc(sphere.radius, 0, -pi / 2 + pi / rows, pi / 2 - pi / rows, rows - 2, rings);
  DrawnMesh mesh;
  addRevolution(rings, -sphere.radius, sphere.radius, segments, mesh);
  return oneMaterial(std::move(mesh));
}

DrawnMesh tessellate(const Box& box) {
  DrawnMesh mesh;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? -1 : 1;
    const Vec3 normal = sign * Vec3::Unit(axis), u = Vec3::Unit((axis + 1) % 3), v = sign * Vec3::Unit((axis + 2) % 3);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& corner :
         {Vec3(normal - u - v), Vec3(normal + u - v), Vec3(normal + u + v), Vec3(normal - u + v)}) {
      mesh.vertices.push_back(0.5 * box.size.cwiseProduct(corner));
      mesh.normals.push_back(normal.cast<float>());
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return oneMaterial(std::move(mesh));
}

DrawnMesh tessellate(const Cylinder& cylinder, int segments) {
  CRADLE_CHECK(segments >= 3);
  const double r = cylinder.radius, top = cylinder.length / 2;
  // Each rim is drawn twice, once with the cap's normal and once with the side's; the strips between are degenerate
  // and dropped below.
  DrawnMesh mesh;
  addRevolution({{r, -top, 0, -1}, {r, -top, 1, 0}, {r, top, 1, 0}, {r, top, 0, 1}}, -top, top, segments, mesh);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const auto& v = mesh.vertices;
    return v[t[0]] == v[t[1]] || v[t[1]] == v[t[2]] || v[t[2]] == v[t[0]];
  });
  return oneMaterial(std::move(mesh));
}

DrawnMesh tessellate(const Capsule& capsule, int segments) {
  CRADLE_CHECK(segments >= 8);
  const int rows = segments / 4;
  const double r = capsule.radius, end = capsule.length / 2, step = pi / 2 / rows;
  std::vector<Ring> rings;
  appendArc(r, -end, -pi / 2 + step, 0, rows - 1, rings);
  appendArc(r, end, 0, pi / 2 - step, rows - 1, rings);
  DrawnMesh mesh;
  addRevolution(rings, -end - r, end + r, segments, mesh);
  return oneMaterial(std::move(mesh));
}

}  // namespace cradle
