#include "render/gpu_mesh.h"

#include <GL/glew.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace cradle {
namespace {

constexpr unsigned int kFirstInstanceAttribute = 2;
constexpr unsigned int kInstanceAttributes = 6;
constexpr unsigned int kCoordinateAttribute = kFirstInstanceAttribute + kInstanceAttributes;
constexpr int kInnermostRing = 8;  // corners of a half sphere's ring next to its middle

const void* byteOffset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}

std::vector<std::uint32_t> flatten(const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) indices.insert(indices.end(), triangle.begin(), triangle.end());
  return indices;
}

void describeAttribute(unsigned int attribute, int components, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(attribute);
  glVertexAttribPointer(attribute, components, GL_FLOAT, GL_FALSE, static_cast<int>(stride), byteOffset(offset));
}

}  // namespace

double cornerOfEqualArea(int corners) {
  const double angle = 2 * std::numbers::pi / corners;
  return std::sqrt(angle / std::sin(angle));
}

InstanceBuffer::InstanceBuffer() {
  glGenBuffers(1, &buffer_);
}

InstanceBuffer::~InstanceBuffer() {
  glDeleteBuffers(1, &buffer_);
}

void InstanceBuffer::upload(const std::vector<Instance>& instances) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.size() * sizeof(Instance)), instances.data(),
               GL_STREAM_DRAW);
}

GpuMesh::GpuMesh(const DrawnMesh& mesh) {
  const bool isTextured = !mesh.textureCoordinates.empty();
  const std::size_t numbers = isTextured ? 8 : 6, stride = numbers * sizeof(float);
  std::vector<float> vertices;
  vertices.reserve(numbers * mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3f position = mesh.vertices[i].cast<float>();
    vertices.insert(vertices.end(), position.begin(), position.end());
    vertices.insert(vertices.end(), mesh.normals[i].begin(), mesh.normals[i].end());
    if (!isTextured) continue;
    const Vec2f& place = mesh.textureCoordinates[i];
    vertices.insert(vertices.end(), {place.x(), 1 - place.y()});  // the rows of pictures begin at the top
  }
  upload(vertices, flatten(mesh.triangles));
  describeAttribute(0, 3, stride, 0);
  describeAttribute(1, 3, stride, 3 * sizeof(float));
  if (isTextured) describeAttribute(kCoordinateAttribute, 2, stride, 6 * sizeof(float));
}

GpuMesh::GpuMesh(const std::vector<float>& vertices, int components, const std::vector<std::uint32_t>& indices) {
  upload(vertices, indices);
  describeAttribute(0, components, static_cast<std::size_t>(components) * sizeof(float), 0);
}

GpuMesh::GpuMesh(GpuMesh&& other) noexcept
    : array_(std::exchange(other.array_, 0)),
      vertices_(std::exchange(other.vertices_, 0)),
      indices_(std::exchange(other.indices_, 0)),
      triangleCount_(other.triangleCount_) {}

GpuMesh::~GpuMesh() {
  glDeleteVertexArrays(1, &array_);
  glDeleteBuffers(1, &vertices_);
  glDeleteBuffers(1, &indices_);
}

void GpuMesh::upload(const std::vector<float>& vertices, const std::vector<std::uint32_t>& indices) {
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &vertices_);
  glGenBuffers(1, &indices_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(float)), vertices.data(),
               GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)), indices.data(),
               GL_STATIC_DRAW);
  triangleCount_ = static_cast<std::uint32_t>(indices.size() / 3);
}

void GpuMesh::draw(std::uint32_t first, std::uint32_t count, const InstanceBuffer& instances, std::size_t firstInstance,
                   std::size_t instanceCount) const {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, instances.name());
  for (unsigned int i = 0; i < kInstanceAttributes; ++i) {
    const unsigned int attribute = kFirstInstanceAttribute + i;
    describeAttribute(attribute, 4, sizeof(Instance), firstInstance * sizeof(Instance) + i * 4 * sizeof(float));
    glVertexAttribDivisor(attribute, 1);
  }
  glDrawElementsInstanced(GL_TRIANGLES, static_cast<int>(3 * count), GL_UNSIGNED_INT,
                          byteOffset(3 * first * sizeof(std::uint32_t)), static_cast<int>(instanceCount));
}

void GpuMesh::draw() const {
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, static_cast<int>(3 * triangleCount_), GL_UNSIGNED_INT, nullptr);
}

GpuMesh makeHalfSphere(int outline) {
  int rings = 1;
  while (kInnermostRing << (rings - 1) < outline) ++rings;
  const double outwards = cornerOfEqualArea(outline);
  std::vector<float> vertices = {0, 1, 0};
  std::vector<std::uint32_t> indices;
  std::uint32_t inner = 0;
  for (int ring = 1; ring <= rings; ++ring) {
    const std::uint32_t count = static_cast<std::uint32_t>(kInnermostRing << (ring - 1));
    const std::uint32_t outer = static_cast<std::uint32_t>(vertices.size() / 3);
    for (std::uint32_t i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count, scale = ring == rings ? outwards : 1;
      vertices.push_back(static_cast<float>(ring) / static_cast<float>(rings));
      vertices.push_back(static_cast<float>(scale * std::cos(angle)));
      vertices.push_back(static_cast<float>(scale * std::sin(angle)));
    }
    // Every ring has twice the corners of the one inside it.
    for (std::uint32_t i = 0; i < count; i += ring == 1 ? 1 : 2) {
      const std::uint32_t a = ring == 1 ? 0 : inner + i / 2, b = outer + i, c = outer + (i + 1) % count;
      indices.insert(indices.end(), {a, b, c});
      if (ring == 1) continue;
      const std::uint32_t next = inner + (i / 2 + 1) % (count / 2);
      indices.insert(indices.end(), {a, c, next, next, c, outer + (i + 2) % count});
    }
    inner = outer;
  }
  return {vertices, 3, indices};
}

GpuMesh makeHalfCylinder(int outline) {
  const int strips = outline / 4;  // inside the outline, a chord only shows where something meets the side
  std::vector<float> vertices;
  std::vector<std::uint32_t> indices;
  for (int i = 0; i <= strips; ++i) {
    const float share = 2 * static_cast<float>(i) / static_cast<float>(strips) - 1;
    vertices.insert(vertices.end(), {-1, share, 0, 1, share, 0});
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(2 * strips); i += 2)
    indices.insert(indices.end(), {i, i + 2, i + 3, i, i + 3, i + 1});

  const std::uint32_t first = static_cast<std::uint32_t>(vertices.size() / 3);
  const double outwards = cornerOfEqualArea(outline);
  for (int i = 0; i < outline; ++i) {
    const double angle = 2 * std::numbers::pi * i / outline;
    vertices.push_back(static_cast<float>(outwards * std::cos(angle)));
    vertices.push_back(static_cast<float>(outwards * std::sin(angle)));
    vertices.push_back(1);
  }
  for (std::uint32_t i = 1; i + 1 < static_cast<std::uint32_t>(outline); ++i)
    indices.insert(indices.end(), {first, first + i, first + i + 1});
  return {vertices, 3, indices};
}

GpuMesh makeTube(int segmentsAlong, int segmentsAround) {
  std::vector<float> vertices;
  std::vector<std::uint32_t> indices;
  const auto around = static_cast<std::uint32_t>(segmentsAround);
  for (int i = 0; i <= segmentsAlong; ++i) {
    for (int j = 0; j < segmentsAround; ++j) {
      const double angle = 2 * std::numbers::pi * j / segmentsAround;
      vertices.push_back(static_cast<float>(i) / static_cast<float>(segmentsAlong));
      vertices.push_back(static_cast<float>(std::cos(angle)));
      vertices.push_back(static_cast<float>(std::sin(angle)));
    }
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(segmentsAlong); ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = i * around + j, b = i * around + (j + 1) % around;
      indices.insert(indices.end(), {a, b, b + around, a, b + around, a + around});
    }
  }
  return {vertices, 3, indices};
}

}  // namespace cradle
