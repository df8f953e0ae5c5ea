#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scene/fault_list.h"
#include "scene/json_document.h"

// Values of a scene file that are drawn: {"draw": {"uniform": [low, high]}}, {"draw": {"normal": [mean, deviation]}},
// both of numbers or of arrays of them, {"draw": {"choice": [...]}} of values that may have draws in them, and
// {"draw": "rotation"}, uniform over all orientations. They are replaced in the tree, before anything is read from it:
// drawn values stand where their draws stood, for messages. An element of an array that is drawn as null is left
// out.

namespace cradle {

/// Adds a fault for each draw that cannot be made.
void checkDraws(const JsonValue& document, FaultList& faults);

/// The first draw of a tree with its JSON pointer; nullptr if there is none.
struct DrawPlace {
  const JsonValue* value = nullptr;
  std::string pointer;
};
DrawPlace firstDraw(const JsonValue& document);

/// JSON pointers of all draws of a tree, in the order of the text, those inside of choices too.
std::vector<std::string> drawPlaces(const JsonValue& document);

/// A number in (0, 1), uniform: number `index` of those that the draw at `pointer` is made of. A number takes one, a
/// choice one, a rotation three.
using UniformSource = std::function<double(const std::string& pointer, std::size_t index)>;

/// The numbers of all draws, by their pointers.
using UniformNumbers = std::map<std::string, std::vector<double>>;

struct DrawnValue {
  std::string pointer;  // of the draw
  JsonValue value;
};

/// A tree in which all draws are made.
struct DrawnDocument {
  JsonValue document;
  std::vector<DrawnValue> values;        // in the order of the text; those inside of a choice behind it
  std::vector<std::string> bodyOrigins;  // pointer into the tree with draws, of each element of `bodies`
};

/// The tree must have passed checkDraws(), its draws are made with numbers from `uniform`.
DrawnDocument drawn(const JsonValue& document, const UniformSource& uniform);

}  // namespace cradle
