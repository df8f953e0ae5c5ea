#include "constraints/block_response.h"

namespace cradle {

double mobilityOf(const ConstraintBlock& row, const std::vector<RigidBody>& bodies,
                  const std::vector<BodyFrame>& frames) {
  BlockResponse response;
  findResponse(row, bodies, frames, response);
  double mobility;
  putDelassus<1>(row, response, &mobility);
  return mobility;
}

}  // namespace cradle
