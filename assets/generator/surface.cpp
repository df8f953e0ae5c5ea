#include "surface.h"

#include <cmath>
#include <numbers>

#include "core/error.h"

namespace cradle::assets {
namespace {

constexpr std::uint32_t kTubeGroup = 1;
constexpr std::size_t kMostVertices = 65535;  // what the format can number

}  // namespace

std::uint16_t Surface::add(const Vec3& vertex) {
  CRADLE_CHECK(vertices.size() < kMostVertices);
  vertices.push_back(vertex);
  return static_cast<std::uint16_t>(vertices.size() - 1);
}

void Surface::addTriangle(std::size_t a, std::size_t b, std::size_t c, std::uint32_t smoothingGroups) {
  CRADLE_CHECK(faces.size() < kMostVertices && a < vertices.size() && b < vertices.size() && c < vertices.size());
  const auto index = [](std::size_t i) { return static_cast<std::uint16_t>(i); };
  faces.push_back({{index(a), index(b), index(c)}, smoothingGroups});
}

void Surface::addQuad(std::size_t a, std::size_t b, std::size_t c, std::size_t d, std::uint32_t smoothingGroups) {
  addTriangle(a, b, c, smoothingGroups);
  addTriangle(a, c, d, smoothingGroups);
}

void addTube(const std::vector<Section>& sections, std::size_t sides, bool isRing, Surface& surface) {
  const std::size_t first = surface.vertices.size(), count = sections.size();
  for (const auto& [center, u, v, radius] : sections)
    for (std::size_t s = 0; s < sides; ++s) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(s) / static_cast<double>(sides);
      surface.add(center + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
  const auto corner = [&](std::size_t section, std::size_t side) {
    return first + section % count * sides + side % sides;
  };
  for (std::size_t i = 0; i + (isRing ? 0 : 1) < count; ++i)
    for (std::size_t s = 0; s < sides; ++s)
      surface.addQuad(corner(i, s), corner(i, s + 1), corner(i + 1, s + 1), corner(i + 1, s), kTubeGroup);
  if (isRing) return;

  const std::size_t start = surface.add(sections.front().center), end = surface.add(sections.back().center);
  for (std::size_t s = 0; s < sides; ++s) {
    surface.addTriangle(start, corner(0, s + 1), corner(0, s), kSharp);
    surface.addTriangle(end, corner(count - 1, s), corner(count - 1, s + 1), kSharp);
  }
}

void addPlateWithHole(const Outline& outer, const Outline& hole, double thickness, Surface& surface) {
  CRADLE_CHECK(outer.points.size() == hole.points.size());
  const std::size_t count = outer.points.size();
  std::array<std::size_t, 4> start{};  // outer bottom, outer top, hole bottom, hole top
  for (std::size_t ring = 0; ring < 4; ++ring) {
    start[ring] = surface.vertices.size();
    const double height = ring % 2 == 0 ? -thickness / 2 : thickness / 2;
    for (const auto& point : ring < 2 ? outer.points : hole.points) surface.add({point.x(), height, -point.y()});
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = (i + 1) % count;
    const auto [outerBottom, outerTop, holeBottom, holeTop] = start;
    surface.addQuad(outerBottom + i, outerBottom + j, outerTop + j, outerTop + i, outer.wallSmoothing);
    surface.addQuad(holeBottom + j, holeBottom + i, holeTop + i, holeTop + j, hole.wallSmoothing);
    surface.addQuad(outerTop + i, outerTop + j, holeTop + j, holeTop + i, kSharp);
    surface.addQuad(outerBottom + j, outerBottom + i, holeBottom + i, holeBottom + j, kSharp);
  }
}

}  // namespace cradle::assets
