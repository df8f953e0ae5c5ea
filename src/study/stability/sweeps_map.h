#pragma once

#include "simulate/assembly.h"
#include "study/stability/gauss_seidel.h"
#include "study/stability/maps.h"

namespace cradle {

/// Bodies that stood still and then fell freely for a moment, at 1 m/s now: what stands below, or what they hang on,
/// has to stop them all.
struct StopProblem {
  Assembly assembly;
  VectorX state;
  std::vector<ConstraintBlock> rows;  // one each
  RowKind kind = RowKind::holds;
};
StopProblem stackToStop(int balls, double topMass);
StopProblem chainToStop(int balls, double bobMass);

/// What a textbook solver's sweeps did.
struct SweepCount {
  double sweeps = 0;  // until nothing moves faster than a thousandth of the start; NaN: more than 3e6
  double factor = 0;  // what a sweep left of the speeds, over the second half of them
};
SweepCount countSweeps(const StopProblem& problem);

/// What our own solver did: one factorisation of all rods, or the frictional contact problem of all contacts.
struct DirectSolution {
  double solves = 0;     // factorisations, or iterations of the cone solver: at least 1
  double speedLeft = 0;  // m/s
};
DirectSolution solveDirectly(const StopProblem& problem);

/// Sweeps against mass ratio, of stacks and chains.
StabilityMap sweepsMap(const MapProgress& progress);

}  // namespace cradle
