#include "scene/attach_textures.h"

#include <fmt/format.h>

#include <map>

#include "core/error.h"

namespace cradle {
namespace {

SharedTexture loadTexture(const TextureDraft& draft, const TextureSource& textures, FaultList& faults) {
  try {
    return textures(draft.path);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mesh) throw;
    addFault(faults, draft.field, error.what());
    return nullptr;
  }
}

}  // namespace

void attachTextures(SceneDraft& draft, const TextureSource& textures, FaultList& textFaults, FaultList& meshFaults) {
  std::map<std::string, SharedTexture> known;
  for (const auto& [material, texture] : draft.textures) {
    const auto [found, isNew] = known.try_emplace(texture.path);
    if (isNew) found->second = loadTexture(texture, textures, meshFaults);
    draft.scene.materials[static_cast<std::size_t>(material)].texture = found->second;
  }
  for (BodyDraft& body : draft.bodies) {
    if (!draft.textures.contains(body.body.material)) continue;
    body.mesh.isTextured = true;
    if (!body.meshField)
      addFault(textFaults, body.field,
               "its material has a texture, which lies where a mesh file says, and its shape is none; give it a "
               "\"mesh\", or the material a \"pattern\" in place of the texture");
  }
}

}  // namespace cradle
