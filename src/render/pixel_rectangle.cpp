#include "render/pixel_rectangle.h"

#include <algorithm>

namespace cradle {

PixelRectangle joined(const PixelRectangle& a, const PixelRectangle& b) {
  if (a.isEmpty()) return b;
  if (b.isEmpty()) return a;
  return {std::min(a.left, b.left), std::min(a.bottom, b.bottom), std::max(a.right, b.right), std::max(a.top, b.top)};
}

PixelRectangle common(const PixelRectangle& a, const PixelRectangle& b) {
  return {std::max(a.left, b.left), std::max(a.bottom, b.bottom), std::min(a.right, b.right), std::min(a.top, b.top)};
}

std::vector<std::vector<PixelRectangle>> groupsApart(const std::vector<PixelRectangle>& rectangles) {
  std::vector<std::vector<PixelRectangle>> groups;
  for (const PixelRectangle& one : rectangles) {
    const auto touches = [&one](const PixelRectangle& other) {
      return one.left <= other.right && other.left <= one.right && one.bottom <= other.top && other.bottom <= one.top;
    };
    const auto fits = std::find_if(groups.begin(), groups.end(), [&](const std::vector<PixelRectangle>& group) {
      return std::none_of(group.begin(), group.end(), touches);
    });
    if (fits == groups.end())
      groups.push_back({one});
    else
      fits->push_back(one);
  }
  return groups;
}

}  // namespace cradle
