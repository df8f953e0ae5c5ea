#include "scene/attach_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/error.h"
#include "mesh/convex_hull.h"
#include "mesh/recognise_shape.h"
#include "mesh/solid.h"
#include "scene/given_mass.h"

namespace cradle {
namespace {

constexpr double kLikelyMillimetres = 20;  // m: larger bodies are rare in scenes, parts of 20 mm are not

/// What there is to know of a model, found once for all bodies that use it.
struct ModelFacts {
  int index = 0;                          // in Scene::models
  bool isClosed = false;                  // has an inner side
  bool isSolid = false;                   // bounds a volume
  std::string problems;                   // why not
  std::optional<MassProperties> uniform;  // at density 1, if it is a solid
  std::optional<MassProperties> ofHull;   // of its hull at density 1, once somebody asked
  std::optional<MassProperties> ofShell;  // of a shell at 1 kg/m^2, once somebody asked
  bool isRecognised = false;              // its shape, once somebody asked
  std::string hullFault;                  // why it has no hull, once somebody asked
  double size = 0;                        // m, radius of a sphere around it
};

/// Models by name; unset for those that could not be had.
using ModelTable = std::map<std::string, std::optional<ModelFacts>>;

struct Faults {
  FaultList& text;
  FaultList& mesh;
};

ModelFacts examine(const Model& model, const SolidReport& report) {
  ModelFacts facts;
  facts.isClosed = report.isClosed;
  facts.isSolid = report.isSolid;
  facts.problems = fmt::format("{}", fmt::join(report.problems, "; "));
  if (report.isSolid) facts.uniform = computeMassProperties(model.solid, 1);
  Bounds bounds;
  for (const Vec3& vertex : model.solid.vertices) bounds.extend(vertex);
  facts.size = bounds.isEmpty() ? 0 : bounds.diagonal().stableNorm() / 2;
  return facts;
}

void warnOfNotes(const Field& field, std::vector<std::string> notes, const std::vector<std::string>& more,
                 FaultList& faults) {
  for (const std::string& note : more) {
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }
  for (const std::string& note : notes) addWarning(faults, field, note);
}

std::optional<ModelFacts> load(const BodyDraft& draft, SceneDraft& scene, const ModelSource& models, Faults faults) {
  try {
    LoadedModel loaded = models(draft.mesh);
    loaded.model.name = modelName(draft.mesh);
    if (draft.mesh.isTextured && loaded.model.drawn.textureCoordinates.empty())
      throw Error(ErrorKind::mesh, draft.mesh.path,
                  "has no texture coordinates (UV), which the texture of its material needs; export it with them");
    const SolidReport report = checkSolid(loaded.model.solid);
    warnOfNotes(*draft.meshField, loaded.notes, report.notes, faults.text);
    ModelFacts facts = examine(loaded.model, report);
    facts.index = static_cast<int>(scene.scene.models.size());
    scene.scene.models.push_back(std::move(loaded.model));
    scene.scene.modelCollisions.emplace_back();
    return facts;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mesh) throw;
    addFault(faults.mesh, *draft.meshField, error.what());
    return std::nullopt;
  }
}

/// Whether a body has no mass unless its mesh encloses a volume.
bool needsVolume(const BodyDraft& draft) {
  return draft.body.motion == Motion::dynamic && draft.massFrom == MassFrom::solid &&
         !(draft.mass && draft.inertiaTensor);
}

// A body that moves has a volume, or a hull or a shell that gives its mass, or the mass itself, if forces move it.
bool canMove(const BodyDraft& draft, const ModelFacts& facts, FaultList& faults) {
  if (facts.isSolid) return true;
  const bool isDriven = draft.body.motion == Motion::driven;
  const bool givesMass = isDriven || draft.massFrom != MassFrom::solid || (draft.mass && draft.inertiaTensor);
  const CollisionChoice choice = draft.body.collision;
  if (givesMass && facts.isClosed) return true;
  if (givesMass && (choice == CollisionChoice::none || choice == CollisionChoice::hull)) return true;
  if (!isDriven && draft.massFrom != MassFrom::solid && choice == CollisionChoice::automatic)
    return true;  // as its hull
  const char* lacks = givesMass    ? "its collision needs a closed surface"
                      : draft.mass ? "mass alone needs a volume for its inertia"
                                   : "a body that moves needs a volume for its mass";
  addFault(
      faults, *draft.meshField,
      fmt::format("{} is no solid ({}), and {}; mend the mesh, or give \"motion\": \"static\", or {}\"collision\": "
                  "\"hull\" or \"none\"",
                  inQuotes(draft.mesh.path), facts.problems, lacks,
                  isDriven ? "" : "\"massFrom\": \"hull\" or \"shell\", or \"mass\" with \"inertiaTensor\" and "));
  return false;
}

/// The hull of a mesh that has one; else the reason why not is kept. True if there is one.
bool hasHull(const TriangleMesh& solid, ModelFacts& facts, ModelCollision& collision) {
  try {
    if (!collision.hull && facts.hullFault.empty()) collision.hull = convexHullOf(solid.vertices);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mesh) throw;
    facts.hullFault = error.what();
  }
  return facts.hullFault.empty();
}

void findHull(const BodyDraft& draft, const TriangleMesh& solid, ModelFacts& facts, ModelCollision& collision,
              FaultList& faults) {
  if (hasHull(solid, facts, collision)) return;
  addFault(faults, draft.collision ? *draft.collision : *draft.meshField,
           fmt::format("{}; give the body \"collision\": \"none\", or a mesh that is not flat", facts.hullFault));
}

// sphere and box are promises about the mesh that it must keep.
void checkPromise(const BodyDraft& draft, bool isClosed, const RecognisedShape& recognised, FaultList& faults) {
  const std::string wanted = draft.body.collision == CollisionChoice::sphere ? "sphere" : "box";
  const std::string shape = isClosed ? shapeName(recognised) : "an open surface";
  if (shape == wanted) return;
  addFault(
      faults, *draft.collision,
      fmt::format("collision is \"{}\", but the mesh is {} ({}); allowed are \"auto\", \"hull\", \"mesh\" and \"none\"",
                  wanted, "no " + wanted, shape));
}

void chooseCollision(const BodyDraft& draft, ModelFacts& facts, Scene& scene, FaultList& faults) {
  const CollisionChoice choice = draft.body.collision;
  if (choice == CollisionChoice::none) return;
  const TriangleMesh& solid = scene.models[static_cast<std::size_t>(facts.index)].solid;
  ModelCollision& collision = scene.modelCollisions[static_cast<std::size_t>(facts.index)];
  if (choice == CollisionChoice::hull) return findHull(draft, solid, facts, collision, faults);
  if (facts.isSolid && !facts.isRecognised) collision.recognised = recogniseShape(solid);
  facts.isRecognised = true;
  if (choice == CollisionChoice::sphere || choice == CollisionChoice::box)
    checkPromise(draft, facts.isClosed, collision.recognised, faults);
  const bool takesPrimitive = collision.recognised.primitive && choice != CollisionChoice::mesh;
  if (collision.recognised.isConvex && !takesPrimitive) findHull(draft, solid, facts, collision, faults);
}

/// At density 1, of what `massFrom` names; unset if that is no solid.
std::optional<MassProperties> uniformMass(const BodyDraft& draft, ModelFacts& facts, Scene& scene, FaultList& faults) {
  if (draft.massFrom == MassFrom::solid) return facts.uniform;
  const TriangleMesh& mesh = scene.models[static_cast<std::size_t>(facts.index)].solid;
  if (draft.massFrom == MassFrom::shell) {
    if (!facts.ofShell) facts.ofShell = computeShellProperties(mesh, 1, 1);
    const auto& [mass, centerOfMass, inertiaTensor] = *facts.ofShell;
    return MassProperties{draft.thickness * mass, centerOfMass, draft.thickness * inertiaTensor};
  }
  ModelCollision& collision = scene.modelCollisions[static_cast<std::size_t>(facts.index)];
  if (!hasHull(mesh, facts, collision)) {
    addFault(faults, *draft.massFromField,
             fmt::format("{}; give the body \"massFrom\": \"shell\" with \"thickness\", or a mesh that is not flat",
                         facts.hullFault));
    return std::nullopt;
  }
  if (!facts.ofHull) facts.ofHull = computeMassProperties(trianglesOf(*collision.hull), 1);
  return facts.ofHull;
}

MassProperties massOf(const BodyDraft& draft, ModelFacts& facts, Scene& scene, FaultList& faults) {
  if (draft.body.motion != Motion::dynamic) return {};
  const std::size_t before = faults.count();
  const std::optional<MassProperties> uniform = uniformMass(draft, facts, scene, faults);
  if (faults.count() != before) return {};
  if (!uniform && !draft.centerOfMass)
    addWarning(faults, draft.field, "the mesh is no solid and centerOfMass is not given; it is taken as [0, 0, 0]");
  const double density = scene.materials[static_cast<std::size_t>(draft.body.material)].density;
  return completeMass(draft, uniform, density, faults);
}

/// Most programs that draw parts write millimetres, and their files do not tell. A body of so many metres that gives
/// neither scale nor units is likely one of them.
void warnOfLikelyUnits(const BodyDraft& draft, const ModelFacts& facts, double mass, FaultList& faults) {
  if (draft.givesUnits || 2 * facts.size < kLikelyMillimetres) return;
  addWarning(faults, *draft.meshField,
             fmt::format("the body is {:.3g} m large and weighs {:.3g} kg; if its file is in millimetres, give the "
                         "shape \"units\": \"mm\", else \"units\": \"m\" silences this",
                         2 * facts.size, mass));
}

/// A mesh may come in any units; as a body it has a size like the other shapes.
bool hasUsableSize(const BodyDraft& draft, const ModelFacts& facts, FaultList& faults) {
  if (kLengths.holds(facts.size)) return true;
  addFault(faults, *draft.meshField,
           fmt::format(
               "the mesh has a radius of {:g} m at scale {:g}; allowed are {:g}..{:g} m; change \"scale\" or \"units\"",
               facts.size, draft.mesh.scale, kLengths.least, kLengths.most));
  return false;
}

void complete(BodyDraft& draft, ModelFacts& facts, SceneDraft& scene, Faults faults) {
  if (!hasUsableSize(draft, facts, faults.text)) return;
  if (draft.body.motion != Motion::fixed && !canMove(draft, facts, faults.mesh)) return;
  const bool isOpen = !facts.isClosed && draft.massFrom != MassFrom::solid && draft.body.motion == Motion::dynamic;
  if (isOpen && draft.body.collision == CollisionChoice::automatic) {
    draft.body.collision = CollisionChoice::hull;
    addWarning(faults.text, *draft.meshField, "the mesh is open: it collides as its convex hull");
  }
  chooseCollision(draft, facts, scene.scene, faults.text);
  const MassProperties properties = massOf(draft, facts, scene.scene, faults.text);
  if (draft.body.motion == Motion::dynamic) warnOfLikelyUnits(draft, facts, properties.mass, faults.text);
  for (int i = draft.firstBody; i < draft.firstBody + draft.bodyCount; ++i) {
    Body& body = scene.scene.bodies[static_cast<std::size_t>(i)];
    body.shape = ModelShape{facts.index};
    body.collision = draft.body.collision;
    body.massProperties = properties;
  }
  draft.size = facts.size;
}

}  // namespace

void attachModels(SceneDraft& draft, const ModelSource& models, FaultList& textFaults, FaultList& meshFaults) {
  const Faults faults{textFaults, meshFaults};
  ModelTable table;
  for (BodyDraft& body : draft.bodies) {
    if (!body.meshField) continue;
    const auto factsOf = [&]() -> std::optional<ModelFacts>& {
      const std::string name = modelName(body.mesh);
      if (!table.contains(name)) table.emplace(name, load(body, draft, models, faults));
      return table.at(name);
    };
    const std::optional<ModelFacts>& asIs = factsOf();
    body.mesh.fillsHoles = asIs && !asIs->isClosed && needsVolume(body);
    if (auto& facts = factsOf()) complete(body, *facts, draft, faults);
  }
}

}  // namespace cradle
