#include "study/study_method.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace cradle {

namespace {

std::vector<StudyMethod> ownMethods() {
  // Limits of step x omega on an undamped oscillator: Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations
  // II", IV.2; of DOP853 by its stability polynomial.
  return {
      {"explicitEuler", "explicit Euler", SettingKind::timeStep, MethodName::explicitEuler, 0, nullptr},
      {"semiImplicitEuler", "semi-implicit Euler", SettingKind::timeStep, MethodName::semiImplicitEuler, 2, nullptr},
      {"rk4", "RK4", SettingKind::timeStep, MethodName::rk4, 2 * std::sqrt(2.0), nullptr},
      {"dop853FixedStep", "DOP853, fixed step", SettingKind::timeStep, MethodName::dop853, 5.96, nullptr},
      {"dop853", "DOP853, adaptive", SettingKind::accuracy, MethodName::dop853, 0, nullptr},
      {"plan", "the scene's plan", SettingKind::accuracy, std::nullopt, 0, nullptr}};
}

/// A scene is first tried at the limit of semi-implicit Euler, which most engines are.
StudyMethod methodOf(const Peer& peer) {
  const double limit = peer.setting == SettingKind::timeStep ? 2 : 0;
  return {peer.name, peer.title, peer.setting, std::nullopt, limit, &peer};
}

}  // namespace

const std::vector<StudyMethod>& studyMethods() {
  static const std::vector<StudyMethod> methods = [] {
    std::vector<StudyMethod> all = ownMethods();
    for (const Peer& peer : peers()) all.push_back(methodOf(peer));
    return all;
  }();
  return methods;
}

std::vector<StudyMethod> studyMethodsNamed(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const StudyMethod& method : studyMethods()) known.push_back(method.name);
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(ErrorKind::usage, "--methods",
                  fmt::format("found \"{}\"; allowed are {}", name, fmt::join(known, ", ")));
  std::vector<StudyMethod> chosen;
  for (const StudyMethod& method : studyMethods())
    if (names.empty() || std::find(names.begin(), names.end(), method.name) != names.end()) chosen.push_back(method);
  return chosen;
}

void choose(const StudyMethod& method, double setting, Scene& scene) {
  scene.method.reset();
  scene.namesAccuracy = method.setting == SettingKind::accuracy;
  if (method.method) scene.method = Method{*method.method, std::nullopt, "method " + method.name};
  if (method.setting == SettingKind::timeStep)
    scene.method->timeStep = setting;
  else
    scene.accuracy = setting;
}

}  // namespace cradle
