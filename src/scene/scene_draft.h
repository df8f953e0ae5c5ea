#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scene/parse_copies.h"
#include "scene/read_fields.h"
#include "scene/scene.h"

// A scene between its text and its final form: some of it waits for the meshes.

namespace cradle {

/// The extent over which the mass of a body is spread.
enum class MassFrom {
  solid,  // its volume
  hull,   // that of its convex hull
  shell,  // its surface, with a thickness
};

/// An entry of `bodies`: one body, or all its copies.
struct BodyDraft {
  Field field;  // the entry
  Body body;    // what the copies have in common; name is the entry's
  std::optional<Field> collision;
  bool isSound = true;  // nothing wrong with the entry: what follows from it can be checked

  std::optional<Field> meshField;
  MeshReference mesh;       // if meshField
  bool givesUnits = false;  // or a scale

  MassFrom massFrom = MassFrom::solid;
  std::optional<Field> massFromField;
  double thickness = 1;               // m, > 0: of a shell
  std::optional<double> mass;         // kg
  std::optional<Vec3> centerOfMass;   // m, body's frame
  std::optional<Mat3> inertiaTensor;  // kg m^2, body's frame

  std::optional<double> size;        // m, radius of the bounding sphere; unset until the shape is there
  Copies copies;                     // where the copies are
  int firstBody = 0, bodyCount = 0;  // its bodies in Scene::bodies
};

/// A pixel of a picture, in place of the point that is seen there.
struct PixelPick {
  Field field;
  int frame = 0;
  double column = 0, row = 0;  // pixels, from the upper left one; whole numbers are centres
};

/// An end of a spring, rod, ... that may be a vertex of a mesh, or what a pixel shows.
struct AnchorDraft {
  Anchor anchor;
  Field field;                         // the anchor, or the link if it says nothing of this end
  std::optional<int> vertex = {};      // index into the solid's vertices
  std::optional<Vec3> nearestTo = {};  // m, body's frame: the vertex that is nearest to it
  std::optional<PixelPick> pick = {};

  bool isOfMesh() const { return vertex || nearestTo; }
};

/// A push whose body or point follow from what is seen, or met by its ray, at the start.
struct PushDraft {
  std::size_t push = 0;  // index into Scene::pushes
  Field field;
  bool namesBody = false;
  std::optional<PixelPick> pick;
};

/// A spring, rod, ... whose length may follow from where its ends are.
struct LinkDraft {
  Field field;  // the entry
  std::variant<Spring, Rod, Rope, BallJoint, Hinge, Slider, Weld> link;
  AnchorDraft anchorA, anchorB;
  std::optional<Field> length;  // unset: the distance at the start
  bool isSound = true;          // nothing wrong with the entry or its bodies
  bool isSettled = false;       // ends known, length filled in
};

/// The picture that a material names as its texture.
struct TextureDraft {
  Field field;
  std::string path;  // as the scene file has it
};

struct SceneDraft {
  Scene scene;
  std::vector<BodyDraft> bodies;
  std::vector<std::size_t> draftOfBody;  // for each of Scene::bodies
  std::vector<LinkDraft> links;
  std::vector<PushDraft> pushes;                        // those that are still to be completed
  std::map<std::string, int> materialIndex, bodyIndex;  // by name
  std::map<int, TextureDraft> textures;                 // by material
};

/// Body or material with the name that `field` holds; a name that nothing has is a fault that says which `noun` it
/// would be.
std::optional<int> findNamed(const Field& field, const std::map<std::string, int>& index, const char* noun,
                             FaultList& faults);

}  // namespace cradle
