#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/part_file.h"
#include "math/types.h"
#include "mesh/triangle_mesh.h"
#include "render/appearance.h"

namespace cradle {

/// Triangles of a mesh with one material; numbers are those that GlbFile gave.
struct GlbPrimitive {
  int positions = 0, normals = 0, indices = 0, material = 0;
  int coordinates = -1;  // on a texture; -1: none
};

/// A glTF 2.0 file in its binary form: a scene of nodes with meshes, and one animation. It is built up in memory, and
/// every part is known by the number that adding it gave.
class GlbFile {
 public:
  static constexpr int kNoParent = -1;

  explicit GlbFile(const std::string& sceneName);
  ~GlbFile();
  GlbFile(const GlbFile&) = delete;
  GlbFile& operator=(const GlbFile&) = delete;

  /// An array of vectors of `width` numbers each (1 to 4), zero until they are set.
  int addVectors(std::size_t count, int width);
  template <typename Vector>
  void set(int array, std::size_t index, const Vector& vector) {
    const auto numbers = vector.template cast<float>().eval();
    setNumbers(array, index, {numbers.data(), static_cast<std::size_t>(numbers.size())});
  }
  int addIndices(std::span<const Triangle> triangles);

  /// Of equal materials, and meshes, there is one; of a texture, too.
  int addMaterial(const std::string& name, const Surface& surface, const SharedTexture& texture, bool isDoubleSided);
  int addMesh(const std::string& name, const std::vector<GlbPrimitive>& primitives);

  /// A node of the scene, or of the node `parent`.
  int addNode(const std::string& name, const RigidTransform& parentFromNode, int parent = kNoParent);
  void setMesh(int node, int mesh);
  /// A perspective camera that looks along the node's -z axis, y up; rad, and width over height.
  void setCamera(int node, double verticalFieldOfView, double aspectRatio);
  /// A light from infinitely far along the node's -z axis (KHR_lights_punctual); linear colour, 0..1.
  void setLight(int node, const Vec3f& color, double intensity);
  void setScale(int node, const Vec3& scale);  // along the node's axes

  /// Lets `values`, one for each of `times` (s; set, and ascending), be the node's "translation", "rotation" (x, y, z,
  /// w) or "scale", and linear between them. Viewers that show no motion show the node as it starts.
  void animate(int node, const std::string& property, int times, int values);

  /// Throws Error(limit) naming `path` if a file with so many bytes of arrays would be too long for its format.
  static void requireFits(std::uint64_t bytes, const std::string& path);

  /// Throws Error(limit), Error(output).
  void write(const std::string& path, PartFile& file);

 private:
  struct Document;
  void setNumbers(int array, std::size_t index, std::span<const float> numbers);
  int addTexture(const SharedTexture& texture);
  int addArray(std::vector<std::uint32_t> words, int width, int componentType);
  void bound(int array);
  void standAsAtStart();

  std::unique_ptr<Document> document_;
  std::vector<std::vector<std::uint32_t>> arrays_;  // of each accessor; floats by their bits
  std::vector<SharedTexture> textures_;             // whose bytes lie behind the arrays
};

}  // namespace cradle
