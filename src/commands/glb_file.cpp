// "glTF 2.0 Specification", Khronos Group, 2021: sections 3.6 (accessors), 3.11 (animations), 4.4 (GLB). assimp writes
// .glb too, but repeats the times for every channel and a mesh for every material, joins vertices less than 1e-5 apart,
// and needs time that grows with the square of the file's length: 26 s for 1000 bodies and 600 frames.

#include "commands/glb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/error.h"

namespace cradle {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

constexpr std::uint32_t kMagic = 0x46546c67, kVersion = 2;                           // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;          // "JSON", "BIN"
constexpr int kFloat = 5126, kUnsigned = 5125, kVertices = 34962, kIndices = 34963;  // as in OpenGL
constexpr std::size_t kWord = sizeof(std::uint32_t);
constexpr std::size_t kHeader = 3 * kWord, kChunkHeader = 2 * kWord;  // bytes

template <typename Vector>
Json floatsOf(const Vector& vector) {
  Json numbers = Json::array();
  for (const auto number : vector) numbers.push_back(static_cast<float>(number));
  return numbers;
}

/// Names in mesh files need not be UTF-8.
std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// The bytes of the words that so many bytes take.
std::size_t wholeWords(std::size_t bytes) {
  return (bytes + kWord - 1) / kWord * kWord;
}

void writeWords(PartFile& file, const std::vector<std::uint32_t>& words) {
  file.write({reinterpret_cast<const char*>(words.data()), kWord * words.size()});
}

}  // namespace

struct GlbFile::Document {
  Json json;
  std::map<std::string, int> known;  // materials and meshes by their text

  Json& node(int number) { return json["nodes"].at(static_cast<std::size_t>(number)); }

  /// The number of an element of `list`: that of an equal one, if there is.
  int addOnce(const char* list, const Json& element) {
    const int next = static_cast<int>(json[list].size());
    const auto [found, isNew] = known.try_emplace(list + textOf(element), next);
    if (isNew) json[list].push_back(element);
    return found->second;
  }
};

GlbFile::GlbFile(const std::string& sceneName) : document_(std::make_unique<Document>()) {
  document_->json = {{"asset", {{"version", "2.0"}, {"generator", "cradle"}}},
                     {"scene", 0},
                     {"scenes", Json::array({{{"name", sceneName}, {"nodes", Json::array()}}})}};
}

GlbFile::~GlbFile() = default;

int GlbFile::addArray(std::vector<std::uint32_t> words, int width, int componentType) {
  Json& json = document_->json;
  const int number = static_cast<int>(arrays_.size());
  constexpr std::array kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const char* type = kTypes.at(static_cast<std::size_t>(width - 1));
  json["accessors"].push_back({{"bufferView", number},
                               {"componentType", componentType},
                               {"count", words.size() / static_cast<std::size_t>(width)},
                               {"type", type}});
  json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 0}, {"byteLength", kWord * words.size()}});
  arrays_.push_back(std::move(words));
  return number;
}

int GlbFile::addVectors(std::size_t count, int width) {
  return addArray(std::vector<std::uint32_t>(count * static_cast<std::size_t>(width)), width, kFloat);
}

int GlbFile::addIndices(std::span<const Triangle> triangles) {
  std::vector<std::uint32_t> indices;
  for (const Triangle& triangle : triangles) indices.insert(indices.end(), triangle.begin(), triangle.end());
  return addArray(std::move(indices), 1, kUnsigned);
}

void GlbFile::setNumbers(int array, std::size_t index, std::span<const float> numbers) {
  std::vector<std::uint32_t>& words = arrays_.at(static_cast<std::size_t>(array));
  CRADLE_CHECK((index + 1) * numbers.size() <= words.size());
  const auto first = words.begin() + static_cast<std::ptrdiff_t>(index * numbers.size());
  std::ranges::transform(numbers, first, [](float number) { return std::bit_cast<std::uint32_t>(number); });
}

/// Says between which values an array is, as the format asks of positions and times.
void GlbFile::bound(int array) {
  Json& accessor = document_->json["accessors"][static_cast<std::size_t>(array)];
  if (accessor.contains("min")) return;
  const std::vector<std::uint32_t>& words = arrays_[static_cast<std::size_t>(array)];
  const std::size_t width = accessor["type"] == "SCALAR" ? 1 : 3;
  for (std::size_t k = 0; k < width; ++k) {
    float least = std::bit_cast<float>(words.at(k)), greatest = least;
    for (std::size_t i = k; i < words.size(); i += width) {
      least = std::min(least, std::bit_cast<float>(words[i]));
      greatest = std::max(greatest, std::bit_cast<float>(words[i]));
    }
    accessor["min"][k] = least;
    accessor["max"][k] = greatest;
  }
}

int GlbFile::addTexture(const SharedTexture& texture) {
  const auto known = std::find(textures_.begin(), textures_.end(), texture);
  const auto number = static_cast<int>(known - textures_.begin());
  if (known != textures_.end()) return number;
  textures_.push_back(texture);
  Json& json = document_->json;
  json["images"].push_back({{"name", texture->name}, {"mimeType", isPng(texture->bytes) ? "image/png" : "image/jpeg"}});
  json["textures"].push_back({{"source", number}});
  return number;
}

int GlbFile::addMaterial(const std::string& name, const Surface& surface, const SharedTexture& texture,
                         bool isDoubleSided) {
  Json color = floatsOf(surface.color);
  color.push_back(1);
  Json material;
  if (!name.empty()) material["name"] = name;
  material["pbrMetallicRoughness"] = {
      {"baseColorFactor", color}, {"metallicFactor", surface.metallic}, {"roughnessFactor", surface.roughness}};
  if (texture) material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", addTexture(texture)}};
  if (isDoubleSided) material["doubleSided"] = true;
  return document_->addOnce("materials", material);
}

int GlbFile::addMesh(const std::string& name, const std::vector<GlbPrimitive>& primitives) {
  Json mesh{{"name", name}};
  for (const GlbPrimitive& primitive : primitives) {
    mesh["primitives"].push_back({{"attributes", {{"POSITION", primitive.positions}, {"NORMAL", primitive.normals}}},
                                  {"indices", primitive.indices},
                                  {"material", primitive.material}});
    if (primitive.coordinates >= 0) mesh["primitives"].back()["attributes"]["TEXCOORD_0"] = primitive.coordinates;
    Json& views = document_->json["bufferViews"];
    for (const int array : {primitive.positions, primitive.normals, primitive.coordinates})
      if (array >= 0) views[static_cast<std::size_t>(array)]["target"] = kVertices;
    views[static_cast<std::size_t>(primitive.indices)]["target"] = kIndices;
    bound(primitive.positions);
  }
  return document_->addOnce("meshes", mesh);
}

int GlbFile::addNode(const std::string& name, const RigidTransform& parentFromNode, int parent) {
  Json& json = document_->json;
  const std::size_t number = json["nodes"].size();
  json["nodes"].push_back({{"name", name},
                           {"translation", floatsOf(parentFromNode.translation)},
                           {"rotation", floatsOf(parentFromNode.rotation.coeffs())}});
  Json& siblings = parent == kNoParent ? json["scenes"][0]["nodes"] : document_->node(parent)["children"];
  siblings.push_back(number);
  return static_cast<int>(number);
}

void GlbFile::setMesh(int node, int mesh) {
  document_->node(node)["mesh"] = mesh;
}

void GlbFile::setCamera(int node, double verticalFieldOfView, double aspectRatio) {
  constexpr double kNearPlane = 0.01;  // m; the format asks for one, and without a far one it reaches infinitely far
  Json& cameras = document_->json["cameras"];
  document_->node(node)["camera"] = cameras.size();
  cameras.push_back(
      {{"type", "perspective"},
       {"perspective", {{"yfov", verticalFieldOfView}, {"aspectRatio", aspectRatio}, {"znear", kNearPlane}}}});
}

void GlbFile::setLight(int node, const Vec3f& color, double intensity) {
  constexpr const char* kExtension = "KHR_lights_punctual";
  document_->json["extensionsUsed"] = Json::array({kExtension});
  Json& lights = document_->json["extensions"][kExtension]["lights"];
  document_->node(node)["extensions"][kExtension]["light"] = lights.size();
  lights.push_back({{"type", "directional"}, {"color", floatsOf(color)}, {"intensity", intensity}});
}

void GlbFile::setScale(int node, const Vec3& scale) {
  document_->node(node)["scale"] = floatsOf(scale);
}

void GlbFile::animate(int node, const std::string& property, int times, int values) {
  bound(times);
  Json& animation = document_->json["animations"][0];
  const std::size_t sampler = animation["samplers"].size();
  animation["samplers"].push_back({{"input", times}, {"output", values}});  // linear, if nothing else is said
  animation["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", property}}}});
}

void GlbFile::requireFits(std::uint64_t bytes, const std::string& path) {
  if (bytes <= UINT32_MAX - kHeader - 2 * kChunkHeader) return;
  throw Error(ErrorKind::limit, path,
              fmt::format("would have {:.1f} GB, and the format ends at 4.3; export FILE.csv, or simulate with fewer "
                          "frames per second",
                          1e-9 * static_cast<double>(bytes)));
}

void GlbFile::standAsAtStart() {
  if (!document_->json.contains("animations")) return;
  const Json& animation = document_->json["animations"][0];
  for (const Json& channel : animation["channels"]) {
    const Json& sampler = animation["samplers"].at(channel["sampler"].get<std::size_t>());
    const Json& target = channel["target"];
    const std::string property = target["path"];
    Json vector = Json::array();
    for (std::size_t k = 0; k < (property == "rotation" ? 4 : 3); ++k)
      vector.push_back(std::bit_cast<float>(arrays_.at(sampler["output"].get<std::size_t>()).at(k)));
    document_->node(target["node"])[property] = vector;
  }
}

void GlbFile::write(const std::string& path, PartFile& file) {
  standAsAtStart();
  std::uint64_t binary = 0;
  Json& views = document_->json["bufferViews"];
  for (std::size_t i = 0; i < arrays_.size(); ++i) {
    views[i]["byteOffset"] = binary;
    binary += kWord * arrays_[i].size();
  }
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    document_->json["images"][i]["bufferView"] = views.size();
    views.push_back({{"buffer", 0}, {"byteOffset", binary}, {"byteLength", textures_[i]->bytes.size()}});
    binary += wholeWords(textures_[i]->bytes.size());
  }
  document_->json["buffers"] = Json::array({{{"byteLength", binary}}});
  std::string text = textOf(document_->json);
  text.resize(wholeWords(text.size()), ' ');
  requireFits(text.size() + binary, path);

  const auto word = [](std::uint64_t number) { return static_cast<std::uint32_t>(number); };
  writeWords(file, {kMagic, kVersion, word(kHeader + 2 * kChunkHeader + text.size() + binary)});
  writeWords(file, {word(text.size()), kJsonChunk});
  file.write(text);
  writeWords(file, {word(binary), kBinaryChunk});
  for (const std::vector<std::uint32_t>& words : arrays_) writeWords(file, words);
  for (const SharedTexture& texture : textures_) {
    file.write(texture->bytes);
    file.write(std::string(wholeWords(texture->bytes.size()) - texture->bytes.size(), '\0'));
  }
}

}  // namespace cradle
