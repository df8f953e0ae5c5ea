// Signed tetrahedra between a reference point and each triangle (B. Mirtich, "Fast and accurate computation of
// polyhedral mass properties", J. Graphics Tools 1(2), 1996, gives the same integrals face by face).
// The reference point is the vertex mean, not the origin: shifting moments back from a distance d costs (d/L)^2
// digits about the origin, d/L about the mean.

#include "mesh/mass_properties.h"

#include "core/error.h"

namespace cradle {
namespace {

// Kahan's compensated sum, entry by entry: 48000 triangles sum as exactly as 12.
template <typename T>
class CompensatedSum {
 public:
  explicit CompensatedSum(const T& zero) : sum_(zero), error_(zero) {}
  void add(const T& value) {
    const T corrected = value - error_;
    const T next = sum_ + corrected;
    error_ = (next - sum_) - corrected;
    sum_ = next;
  }
  const T& total() const { return sum_; }

 private:
  T sum_, error_;
};

// Integrals of 1, x and x x^T over a solid, or over a surface, x measured from `reference`.
struct Moments {
  Vec3 reference = Vec3::Zero();
  double zeroth = 0;           // m^3, or m^2
  Vec3 first = Vec3::Zero();   // m^4, or m^3
  Mat3 second = Mat3::Zero();  // m^5, or m^4
};

Vec3 vertexMean(const TriangleMesh& mesh) {
  CompensatedSum<Vec3> sum(Vec3::Zero());
  for (const Vec3& vertex : mesh.vertices) sum.add(vertex);
  return sum.total() / static_cast<double>(mesh.vertices.size());
}

// The sums over triangles (a, b, c), s = a + b + c, of w, w s and w (a a^T + b b^T + c c^T + s s^T), with a weight w.
template <typename Weight>
Moments weightedSums(const TriangleMesh& mesh, const Weight& weightOf) {
  const Vec3 reference = vertexMean(mesh);
  CompensatedSum<double> zeroth(0);
  CompensatedSum<Vec3> first(Vec3::Zero());
  CompensatedSum<Mat3> second(Mat3::Zero());
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 a = mesh.vertices[i] - reference, b = mesh.vertices[j] - reference, c = mesh.vertices[k] - reference;
    const Vec3 sum = a + b + c;
    const double weight = weightOf(a, b, c);
    zeroth.add(weight);
    first.add(weight * sum);
    second.add(weight * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose()));
  }
  return {reference, zeroth.total(), first.total(), second.total()};
}

// Of a tetrahedron (0, a, b, c): V, V s / 4, V (a a^T + b b^T + c c^T + s s^T) / 20; V = a . (b x c) / 6.
Moments momentsOfSolid(const TriangleMesh& mesh) {
  const Moments sums =
      weightedSums(mesh, [](const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)); });
  return {sums.reference, sums.zeroth / 6, sums.first / 24, sums.second / 120};
}

// Of a triangle: A, A s / 3, A (a a^T + b b^T + c c^T + s s^T) / 12; A = |(b - a) x (c - a)| / 2.
Moments momentsOfSurface(const TriangleMesh& mesh) {
  const Moments sums =
      weightedSums(mesh, [](const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a).norm(); });
  return {sums.reference, sums.zeroth / 2, sums.first / 6, sums.second / 24};
}

// `density`: kg/m^3, or kg/m^2 of a surface.
MassProperties propertiesOf(const Moments& moments, double density) {
  CRADLE_CHECK(density > 0);
  CRADLE_CHECK(moments.zeroth > 0);
  const Vec3 offset = moments.first / moments.zeroth;
  const Mat3 central = moments.second - moments.zeroth * offset * offset.transpose();
  return {density * moments.zeroth, moments.reference + offset,
          density * (central.trace() * Mat3::Identity() - central)};
}

}  // namespace

double signedVolume(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  const Vec3 reference = vertexMean(mesh);
  CompensatedSum<double> sixVolumes(0);
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 a = mesh.vertices[i] - reference, b = mesh.vertices[j] - reference, c = mesh.vertices[k] - reference;
    sixVolumes.add(a.dot(b.cross(c)));
  }
  return sixVolumes.total() / 6;
}

MassProperties computeMassProperties(const TriangleMesh& mesh, double density) {
  return propertiesOf(momentsOfSolid(mesh), density);
}

MassProperties computeShellProperties(const TriangleMesh& mesh, double thickness, double density) {
  return propertiesOf(momentsOfSurface(mesh), thickness * density);
}

}  // namespace cradle
