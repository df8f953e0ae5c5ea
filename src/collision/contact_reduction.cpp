#include "collision/contact_reduction.h"

#include <array>
#include <numbers>

namespace cradle {
namespace {

// Cosine (0.8 degrees): contacts whose normals are as near are those of one face. 0.3 or 8 degrees change no test.
constexpr double kClusterCosine = 1 - 1e-4;
constexpr double kSamePlaceRatio = 1e-9;   // of the size: points as near are one, and heights as near are equal
constexpr double kNormalRounding = 1e-14;  // 90 unit roundoffs: unit normals that differ by less are equal

// Six directions across the normal, 60 degrees apart: (cosine, sine).
constexpr double kCosine60 = 0.5, kSine60 = std::numbers::sqrt3 / 2;
constexpr std::array<std::array<double, 2>, 6> kHexagon = {
    {{1, 0}, {kCosine60, kSine60}, {-kCosine60, kSine60}, {-1, 0}, {-kCosine60, -kSine60}, {kCosine60, -kSine60}}};

/// The contacts of (nearly) one normal.
struct Cluster {
  const std::vector<ContactPoint>& contacts;
  std::vector<std::size_t> members;
  double same;  // m: points and heights that differ by less are equal

  /// The farthest along a direction; among equals the farthest along the other one, then the first.
  std::size_t supportPoint(const Vec3& direction, const Vec3& other) const {
    std::size_t best = members[0];
    for (const std::size_t member : members) {
      const Vec3 ahead = contacts[member].point - contacts[best].point;
      const double along = direction.dot(ahead);
      if (along > same || (along > -same && other.dot(ahead) > same)) best = member;
    }
    return best;
  }

  void markKept(std::vector<char>& isKept) const {
    const Vec3& normal = contacts[members[0]].normal;
    const Vec3 across = normal.unitOrthogonal(), other = normal.cross(across);
    for (const auto& [x, y] : kHexagon) isKept[supportPoint(x * across + y * other, x * other - y * across)] = 1;
    std::size_t deepest = members[0];
    double least = std::numeric_limits<double>::infinity(), leastKept = least;
    for (const std::size_t member : members) {
      const double separation = contacts[member].separation;
      if (separation < least) least = separation, deepest = member;
      if (isKept[member]) leastKept = std::min(leastKept, separation);
    }
    if (least < leastKept - same) isKept[deepest] = 1;
  }

  /// The mean of the normals that were found at one place. Where two mirrored edges meet, each has found the normal of
  /// its own face: their mean is mirrored, too.
  Vec3 normalAt(std::size_t place) const {
    const Vec3 &point = contacts[place].point, &first = contacts[place].normal;
    Vec3 sum = Vec3::Zero();
    bool doDiffer = false;
    for (const std::size_t member : members)
      if ((contacts[member].point - point).norm() <= same) {
        sum += contacts[member].normal;
        doDiffer = doDiffer || (contacts[member].normal - first).norm() > kNormalRounding;
      }
    return doDiffer ? sum.normalized() : first;
  }
};

}  // namespace

void reduceContacts(std::size_t first, double size, std::vector<ContactPoint>& contacts) {
  std::vector<Cluster> clusters;
  for (std::size_t i = first; i < contacts.size(); ++i) {
    std::size_t at = 0;
    while (at < clusters.size() && contacts[clusters[at].members[0]].normal.dot(contacts[i].normal) < kClusterCosine)
      ++at;
    if (at == clusters.size()) clusters.push_back({contacts, {}, kSamePlaceRatio * size});
    clusters[at].members.push_back(i);
  }
  std::vector<char> isKept(contacts.size(), 0);
  std::vector<Vec3> normals(contacts.size());
  for (const Cluster& cluster : clusters) {
    cluster.markKept(isKept);
    for (const std::size_t member : cluster.members) normals[member] = cluster.normalAt(member);
  }
  std::size_t end = first;
  for (std::size_t i = first; i < contacts.size(); ++i)
    if (isKept[i]) {
      contacts[end] = contacts[i];
      contacts[end++].normal = normals[i];
    }
  contacts.erase(contacts.begin() + static_cast<std::ptrdiff_t>(end), contacts.end());
}

}  // namespace cradle
