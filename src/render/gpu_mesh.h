#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace cradle {

/// What tells one drawn thing from another: six attributes of four numbers (surface.vert and tube.vert say which).
using Instance = std::array<float, 24>;

/// Instances of one frame, on the side of OpenGL.
class InstanceBuffer {
 public:
  InstanceBuffer();
  ~InstanceBuffer();
  InstanceBuffer(const InstanceBuffer&) = delete;
  InstanceBuffer& operator=(const InstanceBuffer&) = delete;

  void upload(const std::vector<Instance>& instances);
  unsigned int name() const { return buffer_; }

 private:
  unsigned int buffer_ = 0;
};

/// Triangles on the side of OpenGL, to be drawn any number of times at once.
class GpuMesh {
 public:
  explicit GpuMesh(const DrawnMesh& mesh);
  /// `vertices` has `components` numbers a vertex, attribute 0.
  GpuMesh(const std::vector<float>& vertices, int components, const std::vector<std::uint32_t>& indices);
  ~GpuMesh();
  GpuMesh(GpuMesh&& other) noexcept;
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;

  std::uint32_t triangleCount() const { return triangleCount_; }

  /// Draws triangles [first, first + count) for instances [firstInstance, firstInstance + instanceCount).
  void draw(std::uint32_t first, std::uint32_t count, const InstanceBuffer& instances, std::size_t firstInstance,
            std::size_t instanceCount) const;

  /// Draws all triangles once, without instances.
  void draw() const;

 private:
  void upload(const std::vector<float>& vertices, const std::vector<std::uint32_t>& indices);

  unsigned int array_ = 0, vertices_ = 0, indices_ = 0;
  std::uint32_t triangleCount_ = 0;
};

/// How far the corners of a polygon are from its middle that has the area of a circle of radius 1.
double cornerOfEqualArea(int corners);

/// Half a sphere with 8 * 2^n vertices around its outline (sphere.vert); attribute 0: angle from the middle, 1 at the
/// outline; cosine and sine of the direction around it.
GpuMesh makeHalfSphere(int outline);

/// Half a cylinder's side, and an end with `outline` corners (cylinder.vert says what attribute 0 is).
GpuMesh makeHalfCylinder(int outline);

/// A tube along attribute 0: place along the curve 0..1, cosine and sine of the angle around it (tube.vert).
GpuMesh makeTube(int segmentsAlong, int segmentsAround);

}  // namespace cradle
