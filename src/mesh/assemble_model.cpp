#include "mesh/assemble_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"

namespace cradle {
namespace {

constexpr float kShortestNormal = 1e-6f;  // shorter, or not finite: the file has no direction there

Vec3f unitOrZero(const Vec3f& normal) {
  const float length = normal.norm();
  return length > kShortestNormal && std::isfinite(length) ? Vec3f(normal / length) : Vec3f(Vec3f::Zero());
}

/// Three values of triangle `from` become those of triangle `to`; of what a piece may lack, none.
template <typename T>
void moveCorners(std::size_t from, std::size_t to, std::vector<T>& corners) {
  if (!corners.empty())
    std::copy_n(corners.begin() + static_cast<std::ptrdiff_t>(3 * from), 3,
                corners.begin() + static_cast<std::ptrdiff_t>(3 * to));
}

// Drops triangles with two equal corners; returns how many there were, with those left out before.
std::size_t dropDegenerate(MeshPiece& piece) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < piece.smoothing.size(); ++t) {
    const Vec3 &a = piece.corners[3 * t], &b = piece.corners[3 * t + 1], &c = piece.corners[3 * t + 2];
    if (isDegenerate(a, b, c)) continue;
    if (kept != t) {
      moveCorners(t, kept, piece.corners);
      moveCorners(t, kept, piece.normals);
      moveCorners(t, kept, piece.textureCoordinates);
      piece.smoothing[kept] = piece.smoothing[t];
    }
    ++kept;
  }
  const std::size_t dropped = piece.smoothing.size() - kept;
  piece.corners.resize(3 * kept);
  piece.normals.resize(3 * kept);
  if (!piece.textureCoordinates.empty()) piece.textureCoordinates.resize(3 * kept);
  piece.smoothing.resize(kept);
  return piece.degenerate + dropped;
}

template <typename T>
void append(std::vector<T> values, std::vector<T>& to) {
  if (to.empty())
    to = std::move(values);
  else
    to.insert(to.end(), values.begin(), values.end());
}

// Appends the piece's triangles, a vertex per corner, and its material; returns how many were degenerate.
std::size_t appendPiece(MeshPiece piece, bool continuesMaterial, DrawnMesh& drawn, std::vector<Smoothing>& smoothing) {
  CRADLE_CHECK(piece.corners.size() == 3 * piece.smoothing.size());
  piece.normals.resize(piece.corners.size(), Vec3f::Zero());
  for (Vec3f& normal : piece.normals) normal = unitOrZero(normal);
  const std::size_t degenerate = dropDegenerate(piece);

  if (!continuesMaterial) {
    drawn.materials.push_back(std::move(piece.look));
    drawn.materials.back().firstTriangle = static_cast<std::uint32_t>(smoothing.size());
    drawn.materials.back().triangleCount = 0;
  }
  drawn.materials.back().triangleCount += static_cast<std::uint32_t>(piece.smoothing.size());
  append(std::move(piece.corners), drawn.vertices);
  append(std::move(piece.normals), drawn.normals);
  append(std::move(piece.textureCoordinates), drawn.textureCoordinates);
  append(std::move(piece.smoothing), smoothing);
  return degenerate;
}

std::uint64_t bitsOf(float value) {
  return std::bit_cast<std::uint32_t>(value == 0 ? 0.0f : value);
}

// Corners with bit-equal position, normal and texture coordinates become one vertex: a smooth mesh shrinks to a sixth.
void shareCorners(const Numbering& positions, DrawnMesh& drawn) {
  const bool hasCoordinates = !drawn.textureCoordinates.empty();
  const Numbering numbering = numberDistinct(drawn.vertices.size(), [&](std::size_t v) {
    const Vec3f& n = drawn.normals[v];
    const Vec2f at = hasCoordinates ? drawn.textureCoordinates[v] : Vec2f(Vec2f::Zero());
    return std::array{std::uint64_t{positions.numberOf[v]} << 32 | bitsOf(n.x()), bitsOf(n.y()) << 32 | bitsOf(n.z()),
                      bitsOf(at.x()) << 32 | bitsOf(at.y())};
  });
  for (std::size_t v = 0; v < numbering.firstKey.size(); ++v) {  // firstKey[v] >= v: nothing is read after it changed
    drawn.vertices[v] = drawn.vertices[numbering.firstKey[v]];
    drawn.normals[v] = drawn.normals[numbering.firstKey[v]];
    if (hasCoordinates) drawn.textureCoordinates[v] = drawn.textureCoordinates[numbering.firstKey[v]];
  }
  drawn.vertices.resize(numbering.firstKey.size());
  drawn.normals.resize(numbering.firstKey.size());
  if (hasCoordinates) drawn.textureCoordinates.resize(numbering.firstKey.size());
  for (Triangle& triangle : drawn.triangles)
    for (std::uint32_t& corner : triangle) corner = numbering.numberOf[corner];
}

// What weld makes of the corners, from their numbers. Triangles with equal corners are gone already.
TriangleMesh solidOf(const Numbering& positions, const DrawnMesh& corners) {
  TriangleMesh solid;
  solid.vertices.reserve(positions.firstKey.size());
  for (const std::uint32_t corner : positions.firstKey) {
    solid.vertices.push_back(corners.vertices[corner] + Vec3::Zero());  // -0 becomes 0
  }
  solid.triangles.reserve(corners.triangles.size());
  for (const auto& [a, b, c] : corners.triangles)
    solid.triangles.push_back({positions.numberOf[a], positions.numberOf[b], positions.numberOf[c]});
  return solid;
}

std::string plural(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

LoadedModel assembleModel(const std::string& name, std::vector<MeshPiece> pieces, ModelParts parts) {
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const MeshPiece& a, const MeshPiece& b) { return a.material < b.material; });
  LoadedModel loaded;
  loaded.model.name = name;
  DrawnMesh& drawn = loaded.model.drawn;
  std::vector<Smoothing> smoothing;
  std::size_t degenerate = 0;
  const bool hasCoordinates = std::any_of(pieces.begin(), pieces.end(),
                                          [](const MeshPiece& piece) { return !piece.textureCoordinates.empty(); });
  std::set<std::string> textureFaults;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (hasCoordinates) pieces[p].textureCoordinates.resize(pieces[p].corners.size(), Vec2f::Zero());
    if (!pieces[p].textureFault.empty()) textureFaults.insert(pieces[p].textureFault);
    const bool continuesMaterial = p > 0 && pieces[p].material == pieces[p - 1].material;
    degenerate += appendPiece(std::move(pieces[p]), continuesMaterial, drawn, smoothing);
  }
  std::erase_if(drawn.materials, [](const ModelMaterial& material) { return material.triangleCount == 0; });
  drawn.triangles.reserve(smoothing.size());
  for (std::uint32_t corner = 0; corner < drawn.vertices.size(); corner += 3)
    drawn.triangles.push_back({corner, corner + 1, corner + 2});
  const Numbering positions = numberPositions(drawn.vertices);
  loaded.model.solid = solidOf(positions, drawn);
  if (parts == ModelParts::solidAlone) {
    drawn = {};
  } else {
    fillMissingNormals(smoothing, positions, drawn);
    shareCorners(positions, drawn);
  }

  if (degenerate > 0) loaded.notes.push_back(plural(degenerate, "degenerate triangle") + " dropped");
  loaded.notes.insert(loaded.notes.end(), textureFaults.begin(), textureFaults.end());
  return loaded;
}

LoadedModel joinModels(const std::string& name, const std::vector<LoadedModel>& objects) {
  LoadedModel joined;
  joined.model.name = name;
  DrawnMesh& drawn = joined.model.drawn;
  const bool hasCoordinates = std::any_of(objects.begin(), objects.end(), [](const LoadedModel& object) {
    return !object.model.drawn.textureCoordinates.empty();
  });
  for (const auto& [object, notes] : objects) {
    const auto firstVertex = static_cast<std::uint32_t>(drawn.vertices.size());
    const auto firstTriangle = static_cast<std::uint32_t>(drawn.triangles.size());
    drawn.vertices.insert(drawn.vertices.end(), object.drawn.vertices.begin(), object.drawn.vertices.end());
    drawn.normals.insert(drawn.normals.end(), object.drawn.normals.begin(), object.drawn.normals.end());
    const std::vector<Vec2f>& coordinates = object.drawn.textureCoordinates;
    if (hasCoordinates) {
      drawn.textureCoordinates.insert(drawn.textureCoordinates.end(), coordinates.begin(), coordinates.end());
      drawn.textureCoordinates.resize(drawn.vertices.size(), Vec2f::Zero());
    }
    for (const auto& [a, b, c] : object.drawn.triangles)
      drawn.triangles.push_back({firstVertex + a, firstVertex + b, firstVertex + c});
    for (ModelMaterial material : object.drawn.materials) {
      material.firstTriangle += firstTriangle;
      drawn.materials.push_back(std::move(material));
    }
    for (const std::string& note : notes) joined.notes.push_back(object.name + ": " + note);
  }
  joined.model.solid = weld(drawn.vertices, drawn.triangles);
  return joined;
}

}  // namespace cradle
