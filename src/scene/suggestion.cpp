// Words of other programs, and optimal string alignment (E. Ukkonen, "Algorithms for approximate string matching",
// 1985, with swaps).

#include "scene/suggestion.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include "scene/fault_list.h"

namespace cradle {
namespace {

constexpr std::size_t kLongestName = 64;  // longer names are not worth the time

struct Synonym {
  std::string_view word, ours;
};
constexpr Synonym kSynonyms[] = {
    {"pos", "position"},
    {"location", "position"},
    {"translation", "position"},
    {"rot", "orientation"},
    {"rotation", "orientation"},
    {"quaternion", "orientation"},
    {"vel", "linearVelocity"},
    {"omega", "angularVelocity"},
    {"spin", "angularVelocity"},
    {"fps", "framesPerSecond"},
    {"frameRate", "framesPerSecond"},
    {"friction", "staticFriction"},
    {"mu", "staticFriction"},
    {"bounciness", "restitution"},
    {"elasticity", "restitution"},
    {"color", "baseColor"},
    {"colour", "baseColor"},
    {"inertia", "inertiaTensor"},
    {"ball", "sphere"},
    {"cube", "box"},
    {"static", "motion"},
};

std::string lowered(std::string text) {
  for (char& character : text) character = static_cast<char>(std::tolower(static_cast<unsigned char>(character)));
  return text;
}

// One slip for a short name, a third of the letters for a long one.
std::size_t allowedSlips(const std::string& name) {
  return std::max<std::size_t>(1, name.size() / 3);
}

bool contains(const std::string& whole, const std::string& part) {
  return part.size() >= 4 && lowered(whole).find(lowered(part)) != whole.npos;
}

}  // namespace

std::size_t editDistance(const std::string& a, const std::string& b) {
  const std::string s = lowered(a), t = lowered(b);
  std::vector<std::size_t> beforeLast(t.size() + 1), last(t.size() + 1), row(t.size() + 1);
  for (std::size_t j = 0; j <= t.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= s.size(); ++i) {
    beforeLast = std::exchange(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= t.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (s[i - 1] == t[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && s[i - 1] == t[j - 2] && s[i - 2] == t[j - 1])
        row[j] = std::min(row[j], beforeLast[j - 2] + 1);
    }
  }
  return row[t.size()];
}

const std::string* mostLike(const std::string& name, const std::vector<std::string>& candidates) {
  if (name.empty() || name.size() > kLongestName) return nullptr;
  for (const Synonym& synonym : kSynonyms)
    if (lowered(std::string(synonym.word)) == lowered(name))
      if (const auto found = std::find(candidates.begin(), candidates.end(), synonym.ours); found != candidates.end())
        return &*found;
  const std::string* best = nullptr;
  std::size_t bestDistance = allowedSlips(name) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t longer = std::max(name.size(), candidate.size()),
                      shorter = std::min(name.size(), candidate.size());
    if (longer - shorter >= bestDistance) continue;
    const std::size_t distance = editDistance(name, candidate);
    if (distance < bestDistance) {
      best = &candidate;
      bestDistance = distance;
    }
  }
  for (auto i = candidates.begin(); best == nullptr && i != candidates.end(); ++i) {
    if (contains(*i, name) || contains(name, *i)) best = &*i;
  }
  return best;
}

std::string didYouMean(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string* best = mostLike(name, candidates);
  return best == nullptr ? "" : "; did you mean " + inQuotes(*best) + "?";
}

}  // namespace cradle
