// Colours: M. Okabe, K. Ito, "Color Universal Design", 2008, and P. Tol, "Colour schemes", 2021 (muted): told apart by
// all eyes.

#include "study/chart_curves.h"

#include <array>
#include <map>

namespace cradle {
namespace {

// gnuplot's pointtypes: filled triangle, square, circle, diamond, triangle upside down; the plan's open circles go
// around the markers of what it chose.
constexpr std::array<CurveLook, 6> kOwnLooks = {{{"#CC6677", 9, 1.2, 2, 1},
                                                 {"#882255", 5, 1.1, 2, 1},
                                                 {"#56B4E9", 13, 1.3, 2, 1},
                                                 {"#999933", 11, 1.2, 2, 1},
                                                 {"#332288", 7, 1.1, 2, 1},
                                                 {"#0072B2", 6, 1.9, 3.5, 1}}};
constexpr std::array<int, 4> kPeerMarkers = {6, 4, 8, 12};  // open circle, square, triangle, diamond
constexpr std::array<int, 4> kPeerDashes = {1, 2, 3, 4};

const char* colorOf(const std::string& engine) {
  static const std::map<std::string, const char*> colors = {
      {"bullet", "#000000"}, {"ode", "#CC79A7"}, {"mujoco", "#009E73"}, {"simbody", "#E69F00"}};
  return colors.at(engine);
}

Curve curveOf(const StudyMethod& method, const CurveLook& look, const std::vector<StudyRow>& rows) {
  Curve curve{method.engine(), method.title, look, {}, {}};
  std::vector<double> lostSteps;
  const StudyRow* coarsest = nullptr;
  for (const StudyRow& row : rows) {
    if (row.method != method.name) continue;
    if (row.status == RunStatus::unstable) lostSteps.push_back(row.setting);
    if (row.status != RunStatus::ok) continue;
    if (coarsest == nullptr) coarsest = &row;
    curve.points.push_back({row.cpuSecondsPerSimulatedSecond, row.evaluations, row.error, row.energyDrift,
                            row.constraintDrift, row.penetration});
  }
  for (const double step : lostSteps) {
    if (coarsest == nullptr) break;
    const double part = coarsest->setting / step;
    curve.blowUps.push_back({part * coarsest->cpuSecondsPerSimulatedSecond, part * coarsest->evaluations, 0});
  }
  return curve;
}

}  // namespace

std::vector<Curve> curvesOf(const std::vector<StudyRow>& rows) {
  std::vector<Curve> curves;
  std::map<std::string, std::size_t> places;  // that are taken, by engine
  for (const StudyMethod& method : studyMethods()) {
    const std::size_t place = places[method.engine()]++;
    const CurveLook look =
        method.peer ? CurveLook{colorOf(method.engine()), kPeerMarkers.at(place), 1.2, 1.6, kPeerDashes.at(place)}
                    : kOwnLooks.at(place);
    curves.push_back(curveOf(method, look, rows));
    if (curves.back().points.empty()) curves.pop_back();
  }
  return curves;
}

}  // namespace cradle
