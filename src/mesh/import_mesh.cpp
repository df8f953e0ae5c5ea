// assimp never touches the disk: all files, also those that a file names in turn (.mtl, .bin), reach it through
// MeshFiles, which reads regular files only and limits their size.
// No aiProcess_PreTransformVertices (it merges objects and works in float), no aiProcess_JoinIdenticalVertices (it
// compares normals too, so that cubes stay open, and joins what is closer than an absolute distance).

#include "mesh/import_mesh.h"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <string_view>

#include "core/error.h"
#include "core/output_path.h"
#include "core/read_file.h"
#include "math/elementary.h"
#include "mesh/check_3ds.h"
#include "mesh/confined_child.h"
#include "mesh/imported_bytes.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;
using Affine = Eigen::Affine3d;

// What importers need, with room to spare: larger files among assimp's test models take up to 31 bytes a byte and 0.07
// s a MB.
constexpr std::uint64_t kMemoryPerByte = 48;
constexpr std::uint64_t kMemoryForAnyFile = 256 << 20;  // bytes
constexpr std::uint64_t kMaxMemory = 8ULL << 30;        // bytes
constexpr std::uint64_t kBytesPerSecond = 1 << 20;
constexpr std::uint64_t kSecondsForAnyFile = 3;       // s, of computing
constexpr std::uint64_t kLargestFiles = 256'000'000;  // bytes, a mesh file and those it names together
constexpr std::size_t kMaxParts = 100'000;            // of an obj file
constexpr std::size_t kLongestReason = 300;           // bytes of an importer's words

/// The file itself, and those below its folder.
class MeshFiles : public Assimp::IOSystem {
 public:
  explicit MeshFiles(const std::string& path) : path_(path), folder_(folderOf(path)) {}

  // The bytes stay valid as long as this object. Throws Error(mesh).
  const std::string& read(const std::string& path) {
    const auto known = bytesOf_.find(path);
    if (known != bytesOf_.end()) return known->second;
    std::string bytes = readFile(path, kLargestFiles - total_, ErrorKind::mesh);
    total_ += bytes.size();
    limitMemory(std::min(kMaxMemory, kMemoryForAnyFile + kMemoryPerByte * total_));
    return bytesOf_[path] = std::move(bytes);
  }

  bool Exists(const char* path) const override { return isFile(path) && isAllowed(path); }
  char getOsSeparator() const override { return '/'; }
  void Close(Assimp::IOStream* stream) override { delete stream; }
  Assimp::IOStream* Open(const char* path, const char*) override {
    if (!isFile(path)) return nullptr;  // a missing .mtl is no error: the importer goes on without
    if (!isAllowed(path)) {
      outside_ = path;
      return nullptr;
    }
    const std::string& bytes = read(path);
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }

  /// Whether a path leads to what is below the folder: words about other files are not to be told.
  bool isInFolder(const std::string& path) const { return isBelow(path, folder_); }

  /// A file that was asked for, but is not below the folder; empty if none was.
  const std::string& outside() const { return outside_; }

 private:
  static fs::path folderOf(const std::string& path) {
    std::error_code ignored;  // what is not there is told when it is read
    return fs::canonical(parentOf(path), ignored);
  }
  static bool isFile(const char* path) {
    std::error_code failed;  // a name may be too long
    return fs::is_regular_file(path, failed);
  }
  bool isAllowed(const std::string& path) const { return path == path_ || isInFolder(path); }

  std::string path_, outside_;
  fs::path folder_;
  std::map<std::string, std::string> bytesOf_;  // by path
  std::size_t total_ = 0;
};

std::string lowerExtension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension;
}

/// The texture that a material has for its base colour.
struct ColorMap {
  SharedTexture texture;
  unsigned int set = 0;  // of the texture coordinates that place it
  std::string fault;     // why it is left out, as a note; empty if it is not, or there is none
};

// A file as assimp understood it.
struct ImportedFile {
  std::string path;
  Assimp::Importer importer;  // owns the scene, and the files
  MeshFiles* files = nullptr;
  const aiScene* scene = nullptr;
  Summary3ds summary;               // empty unless a 3ds file
  std::vector<ColorMap> colorMaps;  // of each material
};

/// An importer's words may quote the file: one line of it, of letters.
std::string reasonOf(std::string words) {
  for (char& c : words)
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f) c = ' ';
  if (words.size() > kLongestReason) words = words.substr(0, kLongestReason) + " ...";
  return words;
}

/// The importer takes some 2 kB for each part of an obj file, which takes four bytes there.
void requireFewParts(const std::string& bytes, const std::string& path) {
  std::size_t parts = 0;
  for (std::size_t line = 0; line != bytes.npos && line < bytes.size();) {
    const std::string_view rest = std::string_view(bytes).substr(line);
    parts += rest.starts_with("g ") || rest.starts_with("o ") || rest.starts_with("usemtl ");
    line = bytes.find('\n', line);
    if (line != bytes.npos) ++line;
  }
  if (parts > kMaxParts)
    throw Error(ErrorKind::mesh, path,
                fmt::format("has {} objects, groups and changes of material; at most {} are allowed; join them", parts,
                            kMaxParts));
}

void importFile(const std::string& path, ImportedFile& file) {
  file.path = path;
  auto* files = new MeshFiles(path);  // the importer deletes it
  file.importer.SetIOHandler(files);
  file.files = files;
  const std::string& bytes = files->read(path);
  const bool looksLike3ds = bytes.starts_with("MM") && !file.importer.IsExtensionSupported(lowerExtension(path));
  if (isNamed3ds(path) || looksLike3ds) file.summary = check3ds(bytes, path);
  if (lowerExtension(path) == ".obj") requireFewParts(bytes, path);
  file.scene = file.importer.ReadFile(path, aiProcess_Triangulate | aiProcess_TransformUVCoords);
  if (!files->outside().empty())
    throw Error(ErrorKind::mesh, path,
                fmt::format("names the file \"{}\", which is not below its folder; a mesh may not reach outside of it",
                            files->outside()));
  const std::string words = file.importer.GetErrorString();
  if (words.find("bad_alloc") != words.npos) throw std::bad_alloc();
  if (file.scene == nullptr || file.scene->mRootNode == nullptr)
    throw Error(ErrorKind::mesh, path,
                fmt::format("cannot be read as a mesh: {} (no mesh found); check the file, or export it again as 3ds "
                            "or obj",
                            files->isInFolder(path) ? reasonOf(words) : "it is a link to something else"));
}

Affine toAffine(const aiMatrix4x4& m) {
  Affine affine;
  affine.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, 0, 0, 0, 1;
  return affine;
}

Vec3 toVec3(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

// A mesh of the file where a node places it.
struct Placement {
  std::string object;
  const aiMesh* mesh;
  Affine fileFromMesh;
};

// The importer names the meshes of a 3ds file by their number.
std::size_t numberIn3ds(const aiMesh& mesh) {
  return std::strtoul(mesh.mName.C_Str(), nullptr, 10);
}

std::string objectName(const ImportedFile& file, const aiNode* node, const aiMesh& mesh) {
  const std::string meshName = mesh.mName.C_Str(), nodeName = node == nullptr ? "" : node->mName.C_Str();
  const bool isDummy = nodeName.empty() || nodeName.starts_with("3DSMesh_");  // no keyframer section
  if (isDummy && numberIn3ds(mesh) < file.summary.meshes.size()) return file.summary.meshes[numberIn3ds(mesh)].name;
  // Names in <> are importers' own; so are the ends of names of nodes that fbx files need for their many transforms.
  if (!nodeName.empty() && !nodeName.starts_with("<")) return nodeName.substr(0, nodeName.find("_$AssimpFbx$"));
  return meshName.empty() ? std::filesystem::path(file.path).stem().string() : meshName;
}

void placeMeshes(const ImportedFile& file, const aiNode* node, const Affine& fileFromParent,
                 std::vector<Placement>& placements) {
  if (node == nullptr) return;  // the .raw importer promises children that it does not have
  const Affine fileFromNode = fileFromParent * toAffine(node->mTransformation);
  for (unsigned m = 0; m < node->mNumMeshes; ++m) {
    const aiMesh* mesh = file.scene->mMeshes[node->mMeshes[m]];
    placements.push_back({objectName(file, node, *mesh), mesh, fileFromNode});
  }
  for (unsigned c = 0; c < node->mNumChildren; ++c) placeMeshes(file, node->mChildren[c], fileFromNode, placements);
}

// The keyframer section of a 3ds file may leave meshes out; they are where their vertices are.
void placeForgottenMeshes(const ImportedFile& file, std::vector<Placement>& placements) {
  if (file.summary.meshes.empty()) return;
  for (unsigned m = 0; m < file.scene->mNumMeshes; ++m) {
    const aiMesh* mesh = file.scene->mMeshes[m];
    if (std::none_of(placements.begin(), placements.end(), [&](const Placement& p) { return p.mesh == mesh; }))
      placements.push_back({objectName(file, nullptr, *mesh), mesh, toAffine(file.scene->mRootNode->mTransformation)});
  }
}

float encodedAsSrgb(float linear) {
  if (linear <= 0.0031308f) return 12.92f * linear;  // IEC 61966-2-1
  return static_cast<float>(1.055 * exp(log(linear) / 2.4) - 0.055);
}

std::string materialName(const aiMaterial& material) {
  aiString name;
  material.Get(AI_MATKEY_NAME, name);
  return name.C_Str();
}

/// Names of pictures in mesh files are often those of another machine: with its separators, folders and capitals. Each
/// path below the folder of the mesh that may be meant, the likeliest first.
std::vector<std::string> pathsOfTexture(const std::string& meshPath, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path folder = parentOf(meshPath);
  const std::string last = fs::path(name).filename().string();
  const auto inCase = [&last](char first, char to) {
    std::string cased = last;
    for (char& c : cased)
      if (c >= first && c < first + 26) c = static_cast<char>(c - first + to);
    return cased;
  };
  std::vector<std::string> paths;
  for (const std::string& candidate : {name, last, inCase('A', 'a'), inCase('a', 'A')})
    paths.push_back((folder / candidate).string());
  return paths;
}

/// `bytes` if they can be decoded, else the fault.
ColorMap checkedTexture(const std::string& name, std::string bytes) {
  const std::string fault = textureFault(bytes);
  if (fault.empty()) return {std::make_shared<const Texture>(Texture{name, std::move(bytes)}), 0, ""};
  return {nullptr, 0, fmt::format("its texture \"{}\" {}; drawn without it", reasonOf(name), fault)};
}

/// What a mesh file names as a texture: bytes inside it, or another file.
ColorMap textureNamed(const ImportedFile& file, const std::string& name) {
  if (const aiTexture* inside = file.scene->GetEmbeddedTexture(name.c_str())) {
    if (inside->mHeight != 0)
      return {nullptr, 0, "its texture inside the file is neither PNG nor JPEG; drawn without it"};
    const auto* bytes = reinterpret_cast<const char*>(inside->pcData);
    const std::string own = inside->mFilename.C_Str();
    return checkedTexture(own.empty() ? fs::path(file.path).filename().string() + name : own, {bytes, inside->mWidth});
  }
  for (const std::string& path : pathsOfTexture(file.path, name))
    if (file.files->Exists(path.c_str()))
      return checkedTexture(fs::path(path).filename().string(), file.files->read(path));
  return {nullptr, 0,
          fmt::format("its texture \"{}\" is not in the folder of the mesh; drawn without it", reasonOf(name))};
}

ColorMap readColorMap(const ImportedFile& file, const aiMaterial& material) {
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    aiString name;
    unsigned int set = 0;
    if (material.GetTexture(type, 0, &name, nullptr, &set) != aiReturn_SUCCESS || name.length == 0) continue;
    ColorMap map = textureNamed(file, name.C_Str());
    map.set = set;
    return map;
  }
  return {};
}

/// Materials that name the same picture share it.
void readColorMaps(ImportedFile& file) {
  for (unsigned m = 0; m < file.scene->mNumMaterials; ++m) {
    ColorMap map = readColorMap(file, *file.scene->mMaterials[m]);
    for (const ColorMap& other : file.colorMaps)
      if (map.texture && other.texture && other.texture->name == map.texture->name &&
          other.texture->bytes == map.texture->bytes)
        map.texture = other.texture;
    file.colorMaps.push_back(std::move(map));
  }
}

/// glTF ("glTF 2.0 Specification", section 3.9.2) and obj files multiply a texture with the colour beside it; in other
/// formats it stands in its place.
bool multipliesTextures(const ImportedFile& file) {
  const std::string extension = lowerExtension(file.path);
  return extension == ".gltf" || extension == ".glb" || extension == ".obj";
}

ModelMaterial readMaterial(const ImportedFile& file, unsigned index) {
  ModelMaterial look;
  if (index >= file.scene->mNumMaterials) return look;
  const aiMaterial& material = *file.scene->mMaterials[index];
  look.name = materialName(material);
  const bool isMadeUp = look.name == "%%%DEFAULT" || look.name == AI_DEFAULT_MATERIAL_NAME;
  if (isMadeUp) return look;
  look.texture = file.colorMaps[index].texture;
  if (look.texture) look.baseColor = Vec3f::Ones();
  aiColor3D color;
  if (look.texture && !multipliesTextures(file)) return look;
  if (material.Get(AI_MATKEY_COLOR_DIFFUSE, color) != aiReturn_SUCCESS) return look;
  Vec3f base(color.r, color.g, color.b);
  if (!base.allFinite()) return look;
  base = base.cwiseMax(0).cwiseMin(1);
  const bool isLinear = lowerExtension(file.path) == ".gltf" || lowerExtension(file.path) == ".glb";
  look.baseColor = isLinear ? base.unaryExpr(&encodedAsSrgb) : base;
  return look;
}

// How the triangles of a 3ds piece are smooth where the importer's normals ignore what the file says; else empty. A
// file without smoothing groups leaves it open, and the importer smooths every edge.
std::vector<Smoothing> smoothingOf3ds(const ImportedFile& file, const aiMesh& mesh) {
  const std::size_t number = numberIn3ds(mesh);
  if (number >= file.summary.meshes.size()) return {};
  const auto& inFile = file.summary.meshes[number].smoothingGroups;
  if (inFile.empty()) return std::vector<Smoothing>(mesh.mNumFaces, kSmoothingUnknown);
  if (std::count(inFile.begin(), inFile.end(), 0U) == 0) return {};
  std::vector<std::string> materials;
  for (unsigned m = 0; m < file.scene->mNumMaterials; ++m)
    materials.push_back(materialName(*file.scene->mMaterials[m]));
  const auto groups = file.summary.smoothingOfPiece(number, materials, mesh.mMaterialIndex, mesh.mNumFaces);
  return {groups.begin(), groups.end()};
}

// Normals turn with the inverse transpose. The cofactors are its multiple by the determinant, and exist for flat
// transforms too; a mirroring one swaps the winding, and keeps outward normals outward.
Mat3 normalTransform(const Mat3& linear) {
  Mat3 cofactors;
  cofactors << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)),
      linear.col(0).cross(linear.col(1));
  if (linear.determinant() < 0) cofactors = -cofactors;
  return cofactors / std::max(cofactors.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
}

std::array<unsigned, 3> cornersOf(const ImportedFile& file, const Placement& placement, unsigned face) {
  const aiMesh& mesh = *placement.mesh;
  const unsigned* indices = mesh.mFaces[face].mIndices;
  for (unsigned corner = 0; corner < 3; ++corner)
    if (indices[corner] >= mesh.mNumVertices)
      throw Error(ErrorKind::mesh, file.path,
                  fmt::format("face {} of \"{}\" names vertex {}, but there are only {}; the file is damaged", face,
                              placement.object, indices[corner], mesh.mNumVertices));
  if (placement.fileFromMesh.linear().determinant() < 0) return {indices[0], indices[2], indices[1]};
  return {indices[0], indices[1], indices[2]};
}

/// The texture coordinates of a mesh that place the texture of its material, or the first; null if it has none.
const aiVector3D* coordinatesOf(const ImportedFile& file, const aiMesh& mesh) {
  const unsigned set = mesh.mMaterialIndex < file.colorMaps.size() ? file.colorMaps[mesh.mMaterialIndex].set : 0;
  return mesh.HasTextureCoords(set) ? mesh.mTextureCoords[set] : nullptr;
}

/// Material of a piece, with its texture if that can be drawn.
void readLook(const ImportedFile& file, const aiMesh& mesh, MeshPiece& piece) {
  piece.material = static_cast<int>(mesh.mMaterialIndex);
  piece.look = readMaterial(file, mesh.mMaterialIndex);
  if (mesh.mMaterialIndex < file.colorMaps.size()) piece.textureFault = file.colorMaps[mesh.mMaterialIndex].fault;
  if (!piece.look.texture || coordinatesOf(file, mesh) != nullptr) return;
  piece.textureFault = fmt::format("its texture \"{}\" has no coordinates to lie at; drawn without it",
                                   reasonOf(piece.look.texture->name));
  piece.look.texture = nullptr;
}

Vec2f coordinatesAt(const aiVector3D& place) {
  const Vec2f coordinates(place.x, place.y);
  return coordinates.allFinite() ? coordinates : Vec2f(Vec2f::Zero());
}

MeshPiece readPiece(const ImportedFile& file, const Placement& placement) {
  const aiMesh& mesh = *placement.mesh;
  const Mat3 turnNormal = normalTransform(placement.fileFromMesh.linear());
  MeshPiece piece;
  readLook(file, mesh, piece);
  const aiVector3D* coordinates = coordinatesOf(file, mesh);
  const std::vector<Smoothing> smoothing = smoothingOf3ds(file, mesh);
  const bool hasNormals = mesh.HasNormals() && smoothing.empty();
  piece.corners.reserve(3 * std::size_t{mesh.mNumFaces});
  if (hasNormals) piece.normals.reserve(3 * std::size_t{mesh.mNumFaces});
  for (unsigned face = 0; face < mesh.mNumFaces; ++face) {
    if (mesh.mFaces[face].mNumIndices != 3) continue;  // points and lines
    const std::array<unsigned, 3> vertices = cornersOf(file, placement, face);
    std::array<Vec3, 3> corners;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      corners[corner] = placement.fileFromMesh * toVec3(mesh.mVertices[vertices[corner]]);
      if (!corners[corner].allFinite())
        throw Error(
            ErrorKind::mesh, file.path,
            fmt::format("vertex {} of \"{}\" is not finite; the file is damaged", vertices[corner], placement.object));
    }
    if (isDegenerate(corners[0], corners[1], corners[2])) {
      ++piece.degenerate;
      continue;
    }
    piece.smoothing.push_back(smoothing.empty() ? kSmoothingUnknown : smoothing[face]);
    piece.corners.insert(piece.corners.end(), corners.begin(), corners.end());
    for (const unsigned vertex : vertices) {
      if (hasNormals) piece.normals.push_back((turnNormal * toVec3(mesh.mNormals[vertex])).cast<float>());
      if (coordinates != nullptr) piece.textureCoordinates.push_back(coordinatesAt(coordinates[vertex]));
    }
  }
  return piece;
}

}  // namespace

bool isNamed3ds(const std::string& path) {
  const std::string extension = lowerExtension(path);
  return extension == ".3ds" || extension == ".prj";
}

std::vector<ImportedObject> parseObjects(const std::string& path) {
  ImportedFile file;
  importFile(path, file);
  readColorMaps(file);
  std::vector<Placement> placements;
  placeMeshes(file, file.scene->mRootNode, Affine::Identity(), placements);
  placeForgottenMeshes(file, placements);

  std::vector<ImportedObject> objects;  // pieces of one name are one
  std::map<std::string, std::size_t> numberOf;
  for (const Placement& placement : placements) {
    const auto [named, isNew] = numberOf.emplace(placement.object, objects.size());
    if (isNew) objects.push_back({placement.object, {}});
    objects[named->second].pieces.push_back(readPiece(file, placement));
  }
  return objects;
}

std::vector<ImportedObject> importObjects(const std::string& path) {
  requireRegularFile(path, ErrorKind::mesh);
  std::error_code failed;
  const std::uint64_t size = fs::file_size(path, failed);
  const ChildLimits limits{kMemoryForAnyFile, kMaxMemory,
                           kSecondsForAnyFile + (failed ? 0 : std::min(size, kLargestFiles) / kBytesPerSecond)};
  const auto answer = answerOfChild([&] { return bytesOf(parseObjects(path)); }, limits);
  if (!answer.failure.empty())
    throw Error(
        ErrorKind::mesh, path,
        fmt::format("cannot be read as a mesh: {}; check the file, or export it again as 3ds or obj", answer.failure));
  return objectsFromBytes(answer.bytes, path);
}

}  // namespace cradle
