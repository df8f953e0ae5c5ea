#pragma once

#include <string>

#include "core/error.h"
#include "scene/load_scene.h"

// What the tests of the scene file share: texts, and models that need no files.

namespace cradle {

/// The scene file beside this one that has every key, with values unlike the defaults.
std::string everyKey();

/// A scene with these members besides the required ones; they start on line 2.
std::string sceneWith(const std::string& members);

/// A scene whose only body, a unit sphere named "a", also has these members; they start on line 3.
std::string sceneWithBody(const std::string& members);

/// `text` without its @, and "LINE:COLUMN" of that @, counting characters from 1.
std::string unmarked(std::string text);
std::string markedPlace(const std::string& text);

/// A model source without files: "models/cube.3ds" is the cube [0, scale]^3, "models/open.3ds" the same without its
/// last triangle, "models/turned.3ds" the cube with a note; anything else is missing.
LoadedModel cubeModel(const MeshReference& reference);

/// A texture for every path below models/.
SharedTexture anyTexture(const std::string& path);

/// parseScene with cubeModel, anyTexture and the path "scenes/test.json".
LoadedScene parse(const std::string& text);

/// The error that `text` makes; fails the test if there is none.
Error errorOf(const std::string& text);

}  // namespace cradle
