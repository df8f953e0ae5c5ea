// Chunks: identifier (2 bytes), size with this header (4 bytes), data, child chunks; little-endian (J. van Velsen,
// R. Fercoq, "3D Studio file format", 1997).

#include "file_3ds.h"

#include <bit>

namespace cradle::assets {
namespace {

class ChunkWriter {
 public:
  void begin(std::uint16_t id) {
    number(id);
    open_.push_back(bytes_.size());
    number(std::uint32_t{0});
  }
  void end() {
    const std::size_t sizeAt = open_.back();
    open_.pop_back();
    const auto size = static_cast<std::uint32_t>(bytes_.size() - sizeAt + 2);
    for (std::size_t i = 0; i < 4; ++i) bytes_[sizeAt + i] = static_cast<char>(size >> 8 * i & 0xFF);
  }
  template <typename T>
  void number(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_.push_back(static_cast<char>(value >> 8 * i & 0xFF));
  }
  void real(double value) { number(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  void text(const std::string& value) { bytes_.append(value.c_str(), value.size() + 1); }
  template <typename T>
  void chunk(std::uint16_t id, T value) {
    begin(id);
    number(value);
    end();
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::vector<std::size_t> open_;  // where the sizes of unfinished chunks stand
};

void writeColor(std::uint16_t id, const std::array<std::uint8_t, 3>& color, ChunkWriter& out) {
  out.begin(id);
  out.begin(0x0011);  // three bytes
  for (const std::uint8_t channel : color) out.number(channel);
  out.end();
  out.end();
}

void writeMaterial(const MaterialLook& material, ChunkWriter& out) {
  out.begin(0xAFFF);
  out.begin(0xA000);
  out.text(material.name);
  out.end();
  writeColor(0xA010, {0, 0, 0}, out);         // ambient
  writeColor(0xA020, material.diffuse, out);  // diffuse
  writeColor(0xA030, {90, 90, 90}, out);      // specular
  if (!material.texture.empty()) {
    out.begin(0xA200);
    out.begin(0xA300);
    out.text(material.texture);
    out.end();
    out.end();
  }
  out.end();
}

void writeFaces(const Surface& surface, const std::string& material, ChunkWriter& out) {
  constexpr std::uint16_t kAllEdgesVisible = 7;
  const auto count = static_cast<std::uint16_t>(surface.faces.size());
  out.begin(0x4120);
  out.number(count);
  for (const Face& face : surface.faces) {
    for (const std::uint16_t corner : face.corners) out.number(corner);
    out.number(kAllEdgesVisible);
  }
  out.begin(0x4130);  // faces of a material
  out.text(material);
  out.number(count);
  for (std::uint16_t face = 0; face < count; ++face) out.number(face);
  out.end();
  out.begin(0x4150);  // smoothing groups
  for (const Face& face : surface.faces) out.number(face.smoothingGroups);
  out.end();
  out.end();
}

void writeCoordinates(const Surface& surface, ChunkWriter& out) {
  out.begin(0x4140);
  out.number(static_cast<std::uint16_t>(surface.coordinates.size()));
  for (const Vec2f& place : surface.coordinates)
    for (const float coordinate : place) out.real(coordinate);
  out.end();
}

void writeObject(const Surface& surface, const std::string& material, ChunkWriter& out) {
  out.begin(0x4000);
  out.text(surface.name);
  out.begin(0x4100);  // triangle mesh
  out.begin(0x4110);
  out.number(static_cast<std::uint16_t>(surface.vertices.size()));
  for (const Vec3& vertex : surface.vertices) {
    out.real(vertex.x());
    out.real(-vertex.z());
    out.real(vertex.y());
  }
  out.end();
  writeFaces(surface, material, out);
  if (!surface.coordinates.empty()) writeCoordinates(surface, out);
  out.end();
  out.end();
}

}  // namespace

std::string encode3ds(const Model& model) {
  ChunkWriter out;
  out.begin(0x4D4D);
  out.chunk(0x0002, std::uint32_t{3});  // version of the format
  out.begin(0x3D3D);
  out.chunk(0x3D3E, std::uint32_t{3});  // version of the meshes
  for (const MaterialLook& material : model.materials) writeMaterial(material, out);
  out.chunk(0x0100, std::bit_cast<std::uint32_t>(1.0f));  // master scale
  for (const Surface& object : model.objects) writeObject(object, model.materials[object.material].name, out);
  out.end();
  out.end();
  return out.bytes();
}

}  // namespace cradle::assets
