#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/experiment.h"

namespace cradle {

/// The ledger closes in all frames to `tolerance` (J), and what is booked as numerical stays below `numerical` (J).
inline void expectLedger(const Trajectory& run, double tolerance, double numerical) {
  for (const Frame& frame : run.frames) {
    EXPECT_NEAR(ledgerConstantOf(frame), ledgerConstantOf(run.frames[0]), tolerance) << frame.time;
    EXPECT_LT(std::abs(frame.energy.numerical), numerical) << frame.time;
  }
}

}  // namespace cradle
