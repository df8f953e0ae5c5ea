#include "impact/contact_colors.h"

#include <algorithm>
#include <bit>

namespace cradle {
namespace {

constexpr int kColors = 64;  // a bit each

bool isAgainstFixed(const ManifoldLink& link) {
  return link.bodyB == kFixed;
}

}  // namespace

const ContactColors& ContactColoring::color(const std::vector<ManifoldLink>& active, std::size_t bodies) {
  used_.assign(bodies, 0);
  colorOf_.resize(active.size());
  std::int32_t overflow = 2 * kColors;
  for (const bool againstFixed : {false, true})
    for (std::size_t i = 0; i < active.size(); ++i) {
      const ManifoldLink& link = active[i];
      if (isAgainstFixed(link) != againstFixed) continue;
      std::uint64_t& usedA = used_[static_cast<std::size_t>(link.bodyA)];
      std::uint64_t& usedB = againstFixed ? usedA : used_[static_cast<std::size_t>(link.bodyB)];
      const int color = std::countr_one(usedA | usedB);
      if (color == kColors) {
        colorOf_[i] = overflow++;
        continue;
      }
      usedA |= std::uint64_t{1} << color;
      usedB |= std::uint64_t{1} << color;
      colorOf_[i] = color + (againstFixed ? kColors : 0);
    }

  // Counting sort; colours that nothing has are left out.
  next_.assign(static_cast<std::size_t>(overflow), 0);
  for (const std::int32_t color : colorOf_) ++next_[static_cast<std::size_t>(color)];
  colors_.starts.clear();
  std::size_t start = 0;
  for (std::size_t& next : next_) {
    const std::size_t size = next;
    if (size > 0) colors_.starts.push_back(start);
    next = start;
    start += size;
  }
  colors_.starts.push_back(start);
  colors_.links.resize(active.size());
  for (std::size_t i = 0; i < active.size(); ++i)
    colors_.links[next_[static_cast<std::size_t>(colorOf_[i])]++] = active[i];
  return colors_;
}

}  // namespace cradle
