#pragma once

#include <string>

#include "simulate/one_island.h"

namespace cradle {

constexpr double kLandingStep = 0.01;  // s

inline std::string landing(double restitution, double friction, const std::string& bodies) {
  return fmt::format(R"("duration": 1, "materials": {{"stuff": {{"restitution": {}, "staticFriction": {},
      "dynamicFriction": {}}}}}, "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static",
      "material": "stuff"}}, {}])",
                     restitution, friction, friction / 2, bodies);
}

inline std::string ballOver(const std::string& name, double mass, double height, const Vec3& velocity) {
  return fmt::format(R"({{"name": "{}", "mass": {}, "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "stuff",
    "position": [0, {}, 0], "linearVelocity": {}}})",
                     name, mass, height, vectorText(velocity));
}

}  // namespace cradle
