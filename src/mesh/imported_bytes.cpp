// Counts are 8 bytes and stand before what they count; numbers are as this machine has them.

#include "mesh/imported_bytes.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "core/error.h"

namespace cradle {
namespace {

template <class Number>
void append(const Number& number, std::string& bytes) {
  static_assert(std::is_arithmetic_v<Number>);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(Number));
}

/// Text, or vectors of numbers without gaps between them.
template <class Elements>
void appendAll(const Elements& elements, std::string& bytes) {
  append(std::uint64_t{elements.size()}, bytes);
  const auto raw = std::as_bytes(std::span(elements));
  bytes.append(reinterpret_cast<const char*>(raw.data()), raw.size());
}

class Source {
 public:
  Source(const std::string& bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  template <class Number>
  Number number() {
    Number value;
    std::memcpy(&value, take(sizeof(Number)), sizeof(Number));
    return value;
  }

  /// How many come, each of `size` bytes at the least.
  std::uint64_t count(std::size_t size) {
    const auto count = number<std::uint64_t>();
    if (count > (bytes_.size() - next_) / size) fail();
    return count;
  }

  template <class Elements>
  Elements all() {
    constexpr std::size_t kSize = sizeof(typename Elements::value_type);
    Elements elements;
    elements.resize(count(kSize));
    const std::size_t size = elements.size() * kSize;
    const char* from = take(size);
    if (size > 0) std::memcpy(static_cast<void*>(elements.data()), from, size);
    return elements;
  }

  void requireEnd() const {
    if (next_ != bytes_.size()) fail();
  }
  void require(bool holds) const {
    if (!holds) fail();
  }

 private:
  const char* take(std::size_t size) {
    if (size > bytes_.size() - next_) fail();
    const char* here = bytes_.data() + next_;
    next_ += size;
    return here;
  }

  [[noreturn]] void fail() const {
    throw Error(ErrorKind::mesh, path_, "makes the importer answer what is no mesh; check the file");
  }

  const std::string& bytes_;
  const std::string& path_;
  std::size_t next_ = 0;
};

/// The textures of objects, each once.
std::vector<SharedTexture> texturesOf(const std::vector<ImportedObject>& objects) {
  std::vector<SharedTexture> textures;
  for (const ImportedObject& object : objects)
    for (const MeshPiece& piece : object.pieces)
      if (piece.look.texture && std::find(textures.begin(), textures.end(), piece.look.texture) == textures.end())
        textures.push_back(piece.look.texture);
  return textures;
}

void appendPiece(const MeshPiece& piece, const std::vector<SharedTexture>& textures, std::string& bytes) {
  appendAll(piece.corners, bytes);
  appendAll(piece.normals, bytes);
  appendAll(piece.smoothing, bytes);
  append(piece.degenerate, bytes);
  append(piece.material, bytes);
  appendAll(piece.look.name, bytes);
  for (const float channel : piece.look.baseColor) append(channel, bytes);
  appendAll(piece.textureCoordinates, bytes);
  appendAll(piece.textureFault, bytes);
  const auto texture = std::find(textures.begin(), textures.end(), piece.look.texture);  // the end: none
  append(static_cast<std::uint64_t>(texture - textures.begin()), bytes);
}

MeshPiece readPiece(const std::vector<SharedTexture>& textures, Source& source) {
  MeshPiece piece;
  piece.corners = source.all<std::vector<Vec3>>();
  piece.normals = source.all<std::vector<Vec3f>>();
  piece.smoothing = source.all<std::vector<Smoothing>>();
  piece.degenerate = source.number<std::uint64_t>();
  piece.material = source.number<int>();
  piece.look.name = source.all<std::string>();
  for (float& channel : piece.look.baseColor) channel = source.number<float>();
  piece.textureCoordinates = source.all<std::vector<Vec2f>>();
  piece.textureFault = source.all<std::string>();
  const auto texture = source.number<std::uint64_t>();
  source.require(texture <= textures.size());
  if (texture < textures.size()) piece.look.texture = textures[texture];

  const std::size_t corners = piece.corners.size();
  source.require(corners % 3 == 0 && piece.smoothing.size() == corners / 3);
  source.require(piece.normals.empty() || piece.normals.size() == corners);
  source.require(piece.textureCoordinates.empty() || piece.textureCoordinates.size() == corners);
  source.require(std::all_of(piece.textureCoordinates.begin(), piece.textureCoordinates.end(),
                             [](const Vec2f& place) { return place.allFinite(); }));
  source.require(std::all_of(piece.corners.begin(), piece.corners.end(), [](const Vec3& v) { return v.allFinite(); }));
  const auto isColor = [](float channel) { return channel >= 0 && channel <= 1; };
  source.require(std::all_of(piece.look.baseColor.begin(), piece.look.baseColor.end(), isColor));
  return piece;
}

}  // namespace

std::string bytesOf(const std::vector<ImportedObject>& objects) {
  std::string bytes;
  const std::vector<SharedTexture> textures = texturesOf(objects);
  append(std::uint64_t{textures.size()}, bytes);
  for (const SharedTexture& texture : textures) {
    appendAll(texture->name, bytes);
    appendAll(texture->bytes, bytes);
  }
  append(std::uint64_t{objects.size()}, bytes);
  for (const ImportedObject& object : objects) {
    appendAll(object.name, bytes);
    append(std::uint64_t{object.pieces.size()}, bytes);
    for (const MeshPiece& piece : object.pieces) appendPiece(piece, textures, bytes);
  }
  return bytes;
}

std::vector<ImportedObject> objectsFromBytes(const std::string& bytes, const std::string& path) {
  constexpr std::size_t kMinSize = sizeof(std::uint64_t);  // bytes, of a texture, an object or a piece
  Source source(bytes, path);
  std::vector<SharedTexture> textures;
  for (std::uint64_t left = source.count(kMinSize); left > 0; --left) {
    std::string name = source.all<std::string>();
    textures.push_back(std::make_shared<const Texture>(Texture{std::move(name), source.all<std::string>()}));
  }
  std::vector<ImportedObject> objects;
  for (std::uint64_t left = source.count(kMinSize); left > 0; --left) {
    ImportedObject object{source.all<std::string>(), {}};
    for (std::uint64_t pieces = source.count(kMinSize); pieces > 0; --pieces)
      object.pieces.push_back(readPiece(textures, source));
    objects.push_back(std::move(object));
  }
  source.requireEnd();
  return objects;
}

}  // namespace cradle
