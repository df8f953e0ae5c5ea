#pragma once

#include <algorithm>
#include <vector>

#include "experiments/experiment.h"

// Meshes that bodies slide over: ground with creases along z, closed or a sheet, and bowls.

namespace cradle {

using Profile = std::vector<std::pair<double, double>>;  // m: (x, y) from left to right

inline LoadedModel modelOf(const DrawnMesh& drawn) {
  DrawnMesh mesh = drawn;
  mesh.normals.assign(mesh.vertices.size(), Vec3f::UnitY());
  return {{"ground", weld(mesh.vertices, mesh.triangles), mesh}, {}};
}

/// Two triangles, counter-clockwise a, b, c, d.
inline void addQuad(DrawnMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
}

/// What is below a profile down to y = -2 for z from -2 to 2; of a sheet the top alone.
inline LoadedModel ridgedGround(const Profile& profile, bool isSheet) {
  DrawnMesh mesh;
  for (const auto& [x, y] : profile)
    for (const double z : {-2, 2})
      for (const double height : {y, -2.0}) mesh.vertices.emplace_back(x, height, z);
  const auto at = [](std::size_t i, bool isFront, bool isBottom) {
    return static_cast<std::uint32_t>(4 * i + (isFront ? 2 : 0) + (isBottom ? 1 : 0));
  };
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    addQuad(mesh, at(i, false, false), at(i, true, false), at(i + 1, true, false), at(i + 1, false, false));
    if (isSheet) continue;
    addQuad(mesh, at(i, true, true), at(i, false, true), at(i + 1, false, true), at(i + 1, true, true));
    addQuad(mesh, at(i, true, false), at(i, true, true), at(i + 1, true, true), at(i + 1, true, false));
    addQuad(mesh, at(i, false, true), at(i, false, false), at(i + 1, false, false), at(i + 1, false, true));
  }
  const std::size_t last = profile.size() - 1;
  if (!isSheet) {
    addQuad(mesh, at(0, false, false), at(0, false, true), at(0, true, true), at(0, true, false));
    addQuad(mesh, at(last, true, false), at(last, true, true), at(last, false, true), at(last, false, false));
  }
  return modelOf(mesh);
}

/// Distance (m) of a point from a profile, in the plane of x and y.
inline double distanceFrom(const Profile& profile, const Vec3& point) {
  const Vec3 place(point.x(), point.y(), 0);
  double least = INFINITY;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const Vec3 from(profile[i].first, profile[i].second, 0), to(profile[i + 1].first, profile[i + 1].second, 0);
    const double part = std::clamp((place - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    least = std::min(least, (place - from - part * (to - from)).norm());
  }
  return least;
}

/// The lower half of a sphere of 1 m from the inside, in flat facets: `bands` from the lowest point up to the rim. A
/// closed mesh has an outside 0.1 m below.
inline LoadedModel facetedBowl(int sides, int bands, bool isSheet) {
  DrawnMesh mesh;
  const double quarter = std::acos(0.0);
  const auto addSurface = [&](double radius) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(0, -radius, 0);
    for (int band = 1; band <= bands; ++band)
      for (int side = 0; side < sides; ++side) {
        const double polar = quarter * band / bands, azimuth = 4 * quarter * side / sides;
        mesh.vertices.emplace_back(radius * std::sin(polar) * std::cos(azimuth), -radius * std::cos(polar),
                                   radius * std::sin(polar) * std::sin(azimuth));
      }
    return first;
  };
  const std::uint32_t inner = addSurface(1), outer = isSheet ? 0 : addSurface(1.1);
  const auto at = [&](std::uint32_t first, int band, int side) {
    return first + (band == 0 ? 0 : static_cast<std::uint32_t>(1 + (band - 1) * sides + side % sides));
  };
  for (int side = 0; side < sides; ++side) {
    mesh.triangles.push_back({at(inner, 0, 0), at(inner, 1, side + 1), at(inner, 1, side)});
    if (!isSheet) mesh.triangles.push_back({at(outer, 0, 0), at(outer, 1, side), at(outer, 1, side + 1)});
    for (int band = 1; band < bands; ++band) {
      addQuad(mesh, at(inner, band, side), at(inner, band, side + 1), at(inner, band + 1, side + 1),
              at(inner, band + 1, side));
      if (!isSheet)
        addQuad(mesh, at(outer, band, side), at(outer, band + 1, side), at(outer, band + 1, side + 1),
                at(outer, band, side + 1));
    }
    if (!isSheet)
      addQuad(mesh, at(inner, bands, side), at(inner, bands, side + 1), at(outer, bands, side + 1),
              at(outer, bands, side));
  }
  return modelOf(mesh);
}

/// A run of bodies over a mesh that does not move.
inline Trajectory runOverMesh(const LoadedModel& ground, double accuracy, double duration, const std::string& material,
                              const std::string& bodies) {
  const std::string text =
      fmt::format(R"({{"schema": "cradle-scene/1", "name": "Over a mesh", "duration": {}, "accuracy": {},
    "output": {{"framesPerSecond": 240}}, "materials": {{"m": {{{}}}}},
    "bodies": [{{"name": "ground", "shape": {{"mesh": "ground.obj"}}, "motion": "static", "collision": "mesh",
                 "material": "m"}}, {}]}})",
                  duration, accuracy, material, bodies);
  return simulate(parseScene(text, "ground.json", [&](const MeshReference&) { return ground; }).scene);
}

}  // namespace cradle
