#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "collision/contact_point.h"

// What tests expect of contacts with meshes.

namespace cradle {

inline constexpr double kContactRounding = 1e-14;  // m: some sums and products of lengths of about 1 m

inline bool holdsPoint(const std::vector<ContactPoint>& contacts, const Vec3& point, double tolerance) {
  return std::any_of(contacts.begin(), contacts.end(),
                     [&](const ContactPoint& contact) { return (contact.point - point).norm() < tolerance; });
}

inline void expectAllAlong(const std::vector<ContactPoint>& contacts, const Vec3& normal, double separation,
                           double tolerance = kContactRounding) {
  for (const ContactPoint& contact : contacts) {
    EXPECT_LT((contact.normal - normal).norm(), 10 * tolerance);
    EXPECT_NEAR(contact.separation, separation, tolerance);
  }
}

}  // namespace cradle
