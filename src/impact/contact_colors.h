#pragma once

#include <cstdint>
#include <vector>

#include "collision/persistent_manifold.h"

namespace cradle {

/// Groups of manifolds, one behind the other, in none of which a moving body stands twice.
struct ContactColors {
  std::vector<ManifoldLink> links;
  std::vector<std::size_t> starts;  // of each group in `links`, and their end
};

/// Colours manifolds, each with the first colour that neither of its bodies has; contacts with fixed bodies come last,
/// so that what is held against the world holds best. Beyond 64 contacts of one body, groups of one. `bodies`: number
/// of moving bodies. O(active).
class ContactColoring {
 public:
  const ContactColors& color(const std::vector<ManifoldLink>& active, std::size_t bodies);

  /// Whether a body had a contact in the last colouring.
  bool isTouched(std::size_t body) const { return used_[body] != 0; }

 private:
  ContactColors colors_;
  std::vector<std::uint64_t> used_;  // colours of each body
  std::vector<std::int32_t> colorOf_;
  std::vector<std::size_t> next_;
};

}  // namespace cradle
