#include "study/motion_error.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "trajectory/compare_trajectories.h"

namespace cradle {

double motionError(const std::vector<BodyState>& states, const std::vector<BodyState>& reference) {
  CRADLE_CHECK(states.size() == reference.size());
  double error = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!states[i].position.allFinite() || !states[i].orientation.coeffs().allFinite()) return std::nan("");
    const BodyDifference difference = differenceOf(states[i], reference[i]);
    error = std::max({error, difference.position, difference.orientation});
  }
  return error;
}

}  // namespace cradle
