#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cradle {

constexpr std::uint16_t kNoMaterial = 0xFFFF;

/// A triangle mesh of a 3ds file, without its vertices.
struct Mesh3ds {
  std::string name;
  std::vector<std::uint32_t> smoothingGroups;  // one a face, bits (0: flat); empty if the file does not say
  std::vector<std::string> materials;          // names
  std::vector<std::uint16_t> materialOf;       // one a face: index into materials, or kNoMaterial
};

/// What the importer passes on incompletely of a 3ds file: names only if the file has a keyframer section, smoothing
/// groups only as normals, and there group 0 ("flat") counts as smooth with everything.
struct Summary3ds {
  std::vector<Mesh3ds> meshes;  // in the order of the file

  /// The smoothing groups of the faces of one of the importer's pieces: it splits mesh number `mesh` by material, and
  /// keeps the faces of each in order. `materials` are the importer's. Empty if that cannot be told.
  std::vector<std::uint32_t> smoothingOfPiece(std::size_t mesh, const std::vector<std::string>& materials,
                                              std::size_t material, std::size_t faceCount) const;
};

/// Reads the chunks of a 3ds file that carry geometry and checks them: sizes nest, counts fit the data, indices are in
/// range, vertices finite. The importer itself reserves memory for any count and moves indices into range silently, so
/// that half of all damaged files load as something else. Throws Error(mesh) naming `path` and the byte. O(bytes).
Summary3ds check3ds(const std::string& bytes, const std::string& path);

}  // namespace cradle
