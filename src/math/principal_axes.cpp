#include "math/principal_axes.h"

#include <Eigen/Jacobi>

// Cyclic Jacobi rotations: no angles, and of positive definite tensors small moments are as exact as large ones (J.
// Demmel, K. Veselic, "Jacobi's method is more accurate than QR", SIAM J. Matrix Anal. Appl. 13, 1992).

namespace cradle {

PrincipalAxes principalAxes(const Mat3& tensor) {
  constexpr int kSweeps = 10;  // each squares what is off the diagonal: 5 or 6 leave nothing
  Mat3 rest = tensor;
  PrincipalAxes principal{Vec3::Zero(), Mat3::Identity()};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      Eigen::JacobiRotation<double> rotation;
      if (!rotation.makeJacobi(rest, p, q)) continue;
      rest.applyOnTheLeft(p, q, rotation.adjoint());
      rest.applyOnTheRight(p, q, rotation);
      rest(p, q) = rest(q, p) = 0;
      principal.axes.applyOnTheRight(p, q, rotation);
    }
  }
  principal.moments = rest.diagonal();
  return principal;
}

}  // namespace cradle
