#include "scene/parse_settings.h"

#include <fmt/format.h>

#include "math/rotation.h"
#include "scene/named_accuracy.h"

namespace cradle {
namespace {

constexpr const char* kSchema = "cradle-scene/1";
constexpr Range kAccuracies{kFinestAccuracy, kCoarsestAccuracy};
constexpr double kMaxSteps = 1e10;  // a day of computing for one body; times still differ from step to step
constexpr double kMaxFrames = 1e9;  // a year at 30 a second; keeps frame numbers far from overflow

void parseSchema(ObjectReader& root) {
  const auto field = root.require("schema");
  const auto schema = field ? readText(*field, root.faults()) : std::nullopt;
  if (schema && *schema != kSchema) {
    addFault(root.faults(), *field, fmt::format("schema is {}; allowed is \"{}\"", inQuotes(*schema), kSchema));
  }
}

double parseAccuracy(const Field& field, FaultList& faults) {
  const auto* word = std::get_if<std::string>(&field.value->content);
  const std::string orWords = fmt::format("or {}", kAccuracyWords);
  if (word == nullptr) return readNumber(field, kAccuracies, orWords.c_str(), faults).value_or(kAccuracies.most);
  const std::optional<double> accuracy = accuracyNamed(*word);
  if (!accuracy)
    addFault(faults, field,
             fmt::format("accuracy is {}; allowed is a number in {}..{}, {}", inQuotes(*word), kAccuracies.least,
                         kAccuracies.most, kAccuracyWords));
  return accuracy.value_or(kAccuracies.most);
}

Method parseMethod(const Field& field, FaultList& faults) {
  Method method;
  method.where = faults.where(field.place(), field.pointer);
  ObjectReader reader(field, faults);
  reader.require("name");
  method.name = reader.choice<MethodName>("name",
                                          {{"explicitEuler", MethodName::explicitEuler},
                                           {"semiImplicitEuler", MethodName::semiImplicitEuler},
                                           {"rk4", MethodName::rk4},
                                           {"dop853", MethodName::dop853}},
                                          method.name);
  method.timeStep = reader.optionalNumber("timeStep", kTimeSteps, "s");
  reader.rejectUnknownKeys();
  return method;
}

Output parseOutput(const Field& field, FaultList& faults) {
  Output output;
  output.where = faults.where(field.place(), field.pointer);
  ObjectReader reader(field, faults);
  output.framesPerSecond = reader.number("framesPerSecond", kRates, "1/s", output.framesPerSecond);
  output.width = reader.integer("width", 1, kLargestPicture, output.width);
  output.height = reader.integer("height", 1, kLargestPicture, output.height);
  output.playbackSpeed = reader.number("playbackSpeed", kRates, "", output.playbackSpeed);
  reader.rejectUnknownKeys();
  return output;
}

/// The usual one comes from above.
Light usualLight(const Scene& scene) {
  Light light;
  light.direction = rotationBetween(Vec3::UnitY(), upOf(scene)) * light.direction;
  return light;
}

Light parseLight(const Field& field, const Scene& scene, FaultList& faults) {
  Light light = usualLight(scene);
  ObjectReader reader(field, faults);
  light.direction = reader.direction("direction", light.direction);
  light.color = reader.color("color").value_or(light.color);
  light.intensity = reader.number("intensity", kIntensities, "", light.intensity);
  reader.rejectUnknownKeys();
  return light;
}

void parseLights(ObjectReader& root, Scene& scene) {
  const auto field = root.find("lights");
  if (!field) {
    scene.lights = {usualLight(scene)};
    return;
  }
  for (const Field& item : readItems(*field, root.faults()))
    scene.lights.push_back(parseLight(item, scene, root.faults()));
  if (const auto* array = std::get_if<JsonValue::Array>(&field->value->content); array != nullptr && array->empty()) {
    addFault(root.faults(), *field, "lights is empty; at least one is needed; leave the key out for the usual one");
  }
  if (scene.lights.size() > kMaxLights)
    addFault(root.faults(), *field, fmt::format("{} lights; at most {} are allowed", scene.lights.size(), kMaxLights));
}

}  // namespace

void parseSettings(ObjectReader& root, Scene& scene) {
  FaultList& faults = root.faults();
  const std::size_t faultsBefore = faults.count();
  scene.accuracyWhere = scene.output.where = faults.where(root.field().place(), "");
  parseSchema(root);
  root.require("name");
  scene.name = root.name("name", "");
  scene.description = root.text("description", "");
  root.require("duration");
  scene.duration = root.number("duration", kDurations, "s", 1);
  scene.gravity = root.vector("gravity", kAccelerations, "m/s^2", scene.gravity);
  if (const auto field = root.find("accuracy")) {
    scene.accuracy = parseAccuracy(*field, faults);
    scene.accuracyWhere = faults.where(field->place(), field->pointer);
    scene.namesAccuracy = true;
  }
  if (const auto field = root.find("method")) scene.method = parseMethod(*field, faults);
  if (const auto field = root.find("output")) scene.output = parseOutput(*field, faults);
  parseLights(root, scene);
  scene.look = root.choice<Look>("look", {{"light", Look::light}, {"dark", Look::dark}}, scene.look);
  if (faults.count() != faultsBefore) return;
  if (const auto fault = frameCountFault(scene)) addFault(faults, root.field(), *fault);
  if (const auto fault = stepCountFault(scene)) addFault(faults, *root.find("method"), *fault);
}

std::optional<std::string> frameCountFault(const Scene& scene) {
  const double count = scene.duration * scene.output.framesPerSecond / scene.output.playbackSpeed;
  if (count <= kMaxFrames) return {};
  return fmt::format("duration x framesPerSecond / playbackSpeed gives {} frames; at most {} are allowed", count,
                     kMaxFrames);
}

std::optional<std::string> stepCountFault(const Scene& scene) {
  if (!scene.method || !scene.method->timeStep) return {};
  const double count = scene.duration / *scene.method->timeStep;
  if (count <= kMaxSteps) return {};
  return fmt::format("duration / timeStep gives {:.3g} steps; at most {:g} are allowed", count, kMaxSteps);
}

}  // namespace cradle
