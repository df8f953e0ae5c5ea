#pragma once

#include <string>
#include <vector>

#include "study/work_precision.h"

namespace cradle {

/// How a method is drawn by gnuplot: a colour each of ours, of other engines a colour an engine and a marker a method.
struct CurveLook {
  const char* color;
  int marker;  // pointtype
  double size, lineWidth;
  int dash;  // dashtype
};

/// A run in a chart.
struct ChartPoint {
  double cpu, evaluations, error;  // CPU s a simulated s; of the whole run; as in study.csv
  double energyDrift = 0, constraintDrift = 0, penetration = 0;
};

/// What one method shows of a scene.
struct Curve {
  std::string engine, title;
  CurveLook look;
  std::vector<ChartPoint> points;   // runs that went well, coarse to fine
  std::vector<ChartPoint> blowUps;  // without an error; at the cost that such a run would have
};

/// The methods that have a run that went well, in the order of studyMethods(). Blow-ups have no cost of their own: they
/// get the cost of the coarsest run that went well, times the ratio of the steps.
std::vector<Curve> curvesOf(const std::vector<StudyRow>& rows);

}  // namespace cradle
