// Bodies are put into a scene one after the other, each drawn until it is in none that is there (random sequential
// addition): the draws of a body depend on the bodies before it in the file, never on those behind.

#include "sampling/scene_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include "simulate/assembly.h"
#include "simulate/start_overlaps.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxAttempts = 1000;  // of drawing a body that is in no other: a share of 1 % is found in all but 4e-5

/// Whether a draw stands inside of an entry of `bodies`. That which chooses the entry is not redrawn with it.
bool isInside(const std::string& pointer, const std::string& origin) {
  return pointer.size() > origin.size() && pointer.starts_with(origin) && pointer[origin.size()] == '/';
}

/// How often each entry of `bodies` was drawn again, by its origin.
using Attempts = std::map<std::string, int>;

int attemptsOf(const Attempts& attempts, const std::string& pointer) {
  for (const auto& [origin, count] : attempts)
    if (isInside(pointer, origin)) return count;
  return 0;
}

UniformSource priorOf(std::uint64_t seed, long number, const Attempts& attempts) {
  const RandomStream ofSample = RandomStream(seed).at("prior").at(static_cast<std::uint64_t>(number));
  return [ofSample, &attempts](const std::string& pointer, std::size_t index) {
    const int attempt = attemptsOf(attempts, pointer);
    return ofSample.at(pointer).at(static_cast<std::uint64_t>(attempt)).at(index).nextUniform();
  };
}

bool hasDraws(const DrawnScene& drawn, int entry) {
  const std::string& origin = drawn.bodyOrigins[static_cast<std::size_t>(entry)];
  return std::any_of(drawn.values.begin(), drawn.values.end(),
                     [&](const DrawnValue& value) { return isInside(value.pointer, origin); });
}

/// An entry of `bodies` to be drawn again, and two of whose bodies, or one of them and another, overlap.
struct EntryInOthers {
  int entry;
  const Body *a, *b;
};

/// The first entry with draws that is in those before it, in one without draws or in itself.
std::optional<EntryInOthers> firstInOthers(const DrawnScene& drawn) {
  const Scene& scene = drawn.loaded.scene;
  std::optional<EntryInOthers> first;
  for (const auto& [a, b] : bodiesInEachOther(scene)) {
    const Body &bodyA = scene.bodies[static_cast<std::size_t>(a)], &bodyB = scene.bodies[static_cast<std::size_t>(b)];
    const auto [before, behind] = std::minmax(bodyA.entry, bodyB.entry);
    const int entry = hasDraws(drawn, behind) ? behind : before;
    if (!hasDraws(drawn, entry)) continue;  // a fault of the scene, or mended at the start of its run
    if (!first || entry < first->entry) first = {entry, &bodyA, &bodyB};
  }
  return first;
}

[[noreturn]] void refuseCrowd(const EntryInOthers& crowded) {
  throw Error(ErrorKind::scene, (crowded.b->entry == crowded.entry ? crowded.b : crowded.a)->where,
              fmt::format("is in another body in each of {} draws, in the last \"{}\" in \"{}\"; draw from a larger "
                          "space, or take fewer or smaller bodies",
                          kMaxAttempts, crowded.a->name, crowded.b->name));
}

JsonValue jsonAt(const TextPlace& place, decltype(JsonValue::content) content) {
  return {place, std::move(content)};
}

/// Gives the bumps of a drawn scene a seed, if they have none.
void drawSeedOfBumps(const UniformSource& uniform, DrawnDocument& made) {
  JsonValue* bumps = memberOf(made.document, "bumps");
  auto* members = bumps == nullptr ? nullptr : std::get_if<JsonValue::Object>(&bumps->content);
  if (members == nullptr || memberOf(*bumps, "seed") != nullptr) return;
  const JsonValue seed = jsonAt(bumps->place, std::floor(kBumpSeeds * uniform(kBumpSeedPlace, 0)));
  members->push_back({"seed", bumps->place, seed});
  made.values.push_back({kBumpSeedPlace, seed});
}

bool hasBody(const DrawnScene& drawn, const std::string& name) {
  const std::vector<Body>& bodies = drawn.loaded.scene.bodies;
  return std::any_of(bodies.begin(), bodies.end(), [&](const Body& body) { return body.name == name; });
}

void addChange(const NamedBumpChange& change, JsonValue& bumps) {
  const TextPlace place = bumps.place;
  JsonValue* changes = memberOf(bumps, "changes");
  if (changes == nullptr) {
    auto& members = std::get<JsonValue::Object>(bumps.content);
    changes = &members.emplace_back(JsonMember{"changes", place, jsonAt(place, JsonValue::Array{})}).value;
  }
  std::get<JsonValue::Array>(changes->content)
      .push_back(jsonAt(place, JsonValue::Object{{"body", place, jsonAt(place, change.body)},
                                                 {"impact", place, jsonAt(place, double(change.impact))},
                                                 {"seed", place, jsonAt(place, double(change.seed))}}));
}

/// Lets a path that starts from one folder start from another one.
void moveStart(JsonValue* path, const fs::path& from, const fs::path& to) {
  auto* text = path == nullptr ? nullptr : std::get_if<std::string>(&path->content);
  if (text == nullptr || fs::path(*text).is_absolute()) return;
  *text =
      fs::absolute(from / *text).lexically_normal().lexically_relative(fs::absolute(to).lexically_normal()).string();
}

}  // namespace

SceneSampler::SceneSampler(const std::string& path, const std::string& assetRoot)
    : path_(path),
      text_(readSceneText(path)),
      models_(modelFilesBeside(path, assetRoot)),
      textures_(textureFilesBeside(path, assetRoot)) {
  FaultList faults(path, ErrorKind::scene);
  document_ = readJson(text_, faults);
  checkDraws(document_, faults);
  faults.throwIfAny();
}

DrawnScene SceneSampler::sceneOf(const UniformSource& uniform, const std::vector<NamedBumpChange>& bumpChanges) const {
  UniformNumbers numbers;
  const UniformSource recorded = [&](const std::string& pointer, std::size_t index) {
    std::vector<double>& ofDraw = numbers[pointer];
    ofDraw.resize(std::max(ofDraw.size(), index + 1));
    return ofDraw[index] = uniform(pointer, index);
  };
  DrawnDocument made = drawn(document_, recorded);
  drawSeedOfBumps(recorded, made);
  LoadedScene loaded = parseScene(made.document, path_, models_, textures_);
  DrawnScene scene{std::move(made.document),
                   std::move(made.values),
                   std::move(loaded),
                   std::move(made.bodyOrigins),
                   0,
                   std::move(numbers),
                   bumpChanges};
  if (bumpChanges.empty() || !scene.loaded.scene.bumps) return scene;
  for (const NamedBumpChange& change : bumpChanges)
    if (hasBody(scene, change.body)) addChange(change, *memberOf(scene.document, "bumps"));
  scene.loaded = parseScene(scene.document, path_, models_, textures_);
  return scene;
}

DrawnScene SceneSampler::sample(std::uint64_t seed, long number) const {
  Attempts attempts;
  for (int redrawn = 0;; ++redrawn) {
    DrawnScene scene = sceneOf(priorOf(seed, number, attempts));
    scene.redrawn = redrawn;
    refuseUnsupported(scene.loaded.scene);
    const auto crowded = firstInOthers(scene);
    if (!crowded) return scene;
    if (++attempts[scene.bodyOrigins[static_cast<std::size_t>(crowded->entry)]] == kMaxAttempts) refuseCrowd(*crowded);
  }
}

std::optional<DrawnScene> SceneSampler::possibleSceneOf(const UniformSource& uniform,
                                                        const std::vector<NamedBumpChange>& bumpChanges) const {
  DrawnScene scene = sceneOf(uniform, bumpChanges);
  refuseUnsupported(scene.loaded.scene);
  if (firstInOthers(scene)) return std::nullopt;
  return scene;
}

bool SceneSampler::hasWishes() const {
  const JsonValue* wishes = memberOf(document_, "wishes");
  const auto* list = wishes == nullptr ? nullptr : std::get_if<JsonValue::Array>(&wishes->content);
  return list != nullptr && !list->empty() && std::none_of(list->begin(), list->end(), [](const JsonValue& wish) {
           return memberOf(wish, "draw") != nullptr;
         });
}

std::string textInFolder(const DrawnScene& drawn, const std::string& scenePath, const std::string& folder) {
  JsonValue document = drawn.document;
  const fs::path from = fs::path(scenePath).parent_path();
  if (JsonValue* bodies = memberOf(document, "bodies"))
    for (JsonValue& body : std::get<JsonValue::Array>(bodies->content))
      if (JsonValue* shape = memberOf(body, "shape")) moveStart(memberOf(*shape, "mesh"), from, folder);
  if (JsonValue* materials = memberOf(document, "materials"))
    for (JsonMember& material : std::get<JsonValue::Object>(materials->content))
      moveStart(memberOf(material.value, "texture"), from, folder);
  return writeJson(document);
}

}  // namespace cradle
