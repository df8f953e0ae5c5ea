// The one unit that sees nlohmann-json. Its SAX parser says what is in the text, but not where (its positions are those
// of its read-ahead), so a TokenCursor walks the same text in step and supplies the places. The parser keeps its own
// stack on the heap: depth is limited for those who walk the tree afterwards.

#include "scene/json_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "scene/syntax_fault.h"
#include "scene/token_cursor.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxLevels = 64;
constexpr std::size_t kMaxToken = 1'000'000;   // characters of a number; 800 say all that a double holds
constexpr std::size_t kMaxKeys = 10'000;       // of an object; that of materials has most, and 4000 at most
constexpr std::size_t kMaxValues = 4'000'000;  // some 300 MB; a hundred thousand bodies have fewer

class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  TreeBuilder(const std::string& text, FaultList& faults) : cursor_(text), faults_(faults) {}

  JsonValue takeRoot() { return std::move(root_); }

  bool null() override { return addLeaf(nullptr); }
  bool boolean(bool value) override { return addLeaf(value); }
  bool number_integer(number_integer_t value) override { return addLeaf(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return addLeaf(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) override { return addLeaf(value); }
  bool string(string_t& value) override { return addLeaf(std::move(value)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(JsonValue::Object{}); }
  bool start_array(std::size_t) override { return open(JsonValue::Array{}); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& key) override;
  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& error) override;

 private:
  struct Level {
    JsonValue* value;  // stays in place: nothing is added to its parent before it is closed
    std::unordered_map<std::string, TextPlace> keys;
  };

  JsonValue* add(JsonValue value);
  bool addLeaf(decltype(JsonValue::content) content);
  bool open(decltype(JsonValue::content) content);
  bool close();
  std::string pointer() const;

  TokenCursor cursor_;
  FaultList& faults_;
  JsonValue root_;
  std::vector<Level> levels_;
};

JsonValue* TreeBuilder::add(JsonValue value) {
  if (levels_.empty()) return &(root_ = std::move(value));
  auto& parent = levels_.back().value->content;
  if (auto* array = std::get_if<JsonValue::Array>(&parent)) return &array->emplace_back(std::move(value));
  return &(std::get<JsonValue::Object>(parent).back().value = std::move(value));
}

bool TreeBuilder::addLeaf(decltype(JsonValue::content) content) {
  const TextPlace place = cursor_.takeToken();
  add({place, std::move(content)});
  return true;
}

bool TreeBuilder::open(decltype(JsonValue::content) content) {
  const TextPlace place = cursor_.takeToken();
  JsonValue* value = add({place, std::move(content)});
  if (levels_.size() == kMaxLevels) {
    faults_.add(place, "", fmt::format("brackets nest deeper than {0} levels; at most {0} are allowed", kMaxLevels));
    return false;
  }
  levels_.push_back({value, {}});
  return true;
}

bool TreeBuilder::close() {
  cursor_.takeToken();
  levels_.pop_back();
  return true;
}

bool TreeBuilder::key(string_t& key) {
  const TextPlace place = cursor_.takeToken();
  auto& object = std::get<JsonValue::Object>(levels_.back().value->content);
  if (object.size() == kMaxKeys) {
    faults_.add(place, "", fmt::format("an object of more than {} keys", kMaxKeys));
    return false;
  }
  object.push_back({key, place, {}});
  const auto [first, isNew] = levels_.back().keys.emplace(key, place);
  if (!isNew && faults_.isFull()) return false;  // a text of millions
  if (!isNew) {
    faults_.add(place, pointer(),
                fmt::format("duplicate key {}; each key may stand once in an object; the first is at {}:{}",
                            inQuotes(key), first->second.line, first->second.column));
  }
  return true;
}

bool TreeBuilder::parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& error) {
  const std::string reason = error.what();
  const bool isBadByte = reason.find("ill-formed UTF-8") != reason.npos;
  cursor_.returnToTokenWith(position - 1);  // 0x10 is a number, 0, and more
  TextPlace place = cursor_.findToken();
  const bool followsComma = cursor_.followsComma();
  const std::string token(cursor_.rest().substr(0, kLongestOffender));
  if (isBadByte) place = cursor_.advanceTo(position - 1);
  std::string what = explainSyntaxFault(token, followsComma, reason);
  if (token.empty() && !levels_.empty()) {
    const TextPlace opened = levels_.back().value->place;
    what += fmt::format("; the bracket at {}:{} is not closed", opened.line, opened.column);
  }
  faults_.add(place, pointer(), what);
  return false;
}

std::string TreeBuilder::pointer() const {
  std::string result;
  for (const Level& level : levels_) {
    if (const auto* array = std::get_if<JsonValue::Array>(&level.value->content)) {
      if (!array->empty()) result = pointerTo(result, array->size() - 1);
    } else if (const auto& object = std::get<JsonValue::Object>(level.value->content); !object.empty()) {
      result = pointerTo(result, object.back().key);
    }
  }
  return result;
}

/// Where what begins at `start` outside of strings ends: a comment, a string, or one byte.
std::size_t endOfPiece(const std::string& text, std::size_t start) {
  const std::string_view rest = std::string_view(text).substr(start);
  const auto after = [&](std::string_view mark, std::size_t size) {
    const auto found = rest.find(mark, 2);
    return found == rest.npos ? text.size() : start + found + size;
  };
  if (rest.starts_with("//")) return after("\n", 0);
  if (rest.starts_with("/*")) return after("*/", 2);
  if (rest[0] != '"') return start + 1;
  std::size_t end = start + 1;
  while (end < text.size() && text[end] != '"' && text[end] != '\n') end += text[end] == '\\' ? 2 : 1;
  return std::min(end + 1, text.size());
}

/// Whether the comment from `start` to `end` has its own end, not that of the text.
bool isClosedComment(const std::string& text, std::size_t start, std::size_t end) {
  return text[start + 1] != '*' || (end >= start + 4 && text.compare(end - 2, 2, "*/") == 0);
}

/// What can be told of a text in one pass, before the parser makes a tree of it: what is too much for that, and the
/// text with spaces in place of its comments and of other blanks between tokens; all else keeps its place. The parser
/// copies what is before a token that it does not know into its message, a line feed as eight characters: of 60 MB of
/// them for a minute. A comment without an end is cut after its beginning.
class TextSurvey {
 public:
  explicit TextSurvey(const std::string& text) : plain(text), text_(text) {
    for (std::size_t start = 0; start < text.size() && !excess;) start = pass(start);
  }

  std::string plain;
  struct Excess {
    std::size_t offset;
    std::string what;
  };
  std::optional<Excess> excess;

 private:
  std::size_t pass(std::size_t start);
  void count(std::size_t start, std::size_t end);

  const std::string& text_;
  std::size_t values_ = 0, word_ = 0;  // word_: characters of the one that goes on
  char first_ = 0;                     // of all tokens: a text that does not begin with a bracket is no tree
};

/// Passes what begins at `start`; returns where it ends.
std::size_t TextSurvey::pass(std::size_t start) {
  const char byte = text_[start];
  if (byte == ' ' || byte == '\n' || byte == '\r' || byte == '\t') {
    word_ = 0;
    plain[start] = ' ';
    return start + 1;
  }
  const std::size_t end = byte == '"' || byte == '/' ? endOfPiece(text_, start) : start + 1;
  if (byte != '/' || end == start + 1) {
    count(start, end);
    return end;
  }
  word_ = 0;
  if (!isClosedComment(text_, start, end)) {
    plain.resize(start + 2);
    return text_.size();
  }
  std::fill(plain.begin() + std::ptrdiff_t(start), plain.begin() + std::ptrdiff_t(end), ' ');
  return end;
}

/// Values are brackets that open, strings but for keys, and words.
void TextSurvey::count(std::size_t start, std::size_t end) {
  const char byte = text_[start];
  if (first_ == 0) first_ = byte;
  switch (byte) {
    case ':':
      values_ -= values_ > 0;
      [[fallthrough]];
    case ',':
    case ']':
    case '}':
      word_ = 0;
      return;
    case '"':
    case '[':
    case '{':
      word_ = 0;
      ++values_;
      break;
    default:
      values_ += word_ == 0;
      word_ += end - start;
  }
  if (word_ > kMaxToken) excess = {start, fmt::format("a word of more than {} characters", kMaxToken)};
  if (values_ > kMaxValues && (first_ == '{' || first_ == '['))
    excess = {start, fmt::format("the text has more than {} values", kMaxValues)};
}

}  // namespace

namespace {

bool isLeaf(const JsonValue& value) {
  return !std::holds_alternative<JsonValue::Array>(value.content) &&
         !std::holds_alternative<JsonValue::Object>(value.content);
}

std::string textOfLeaf(const JsonValue& value) {
  struct {
    std::string operator()(std::nullptr_t) const { return "null"; }
    std::string operator()(bool truth) const { return truth ? "true" : "false"; }
    std::string operator()(double number) const {
      return number == 0 && std::signbit(number) ? "-0.0" : fmt::format("{}", number);  // "-0" is read as 0
    }
    std::string operator()(const std::string& text) const { return nlohmann::json(text).dump(); }
    std::string operator()(const JsonValue::Array&) const { return "[]"; }
    std::string operator()(const JsonValue::Object&) const { return "{}"; }
  } text;
  return std::visit(text, value.content);
}

/// Appends a value whose lines after the first begin with `indent`.
void appendValue(const JsonValue& value, const std::string& indent, std::string& text) {
  const std::string inside = indent + "  ";
  const auto* array = std::get_if<JsonValue::Array>(&value.content);
  const auto* object = std::get_if<JsonValue::Object>(&value.content);
  if (array != nullptr && std::all_of(array->begin(), array->end(), isLeaf)) {
    text += '[';
    for (const JsonValue& element : *array) text += (&element == array->data() ? "" : ", ") + textOfLeaf(element);
    text += ']';
  } else if (array != nullptr) {
    for (const JsonValue& element : *array) {
      text += (&element == array->data() ? "[\n" : ",\n") + inside;
      appendValue(element, inside, text);
    }
    text += '\n' + indent + ']';
  } else if (object != nullptr && !object->empty()) {
    for (const JsonMember& member : *object) {
      text += (&member == object->data() ? "{\n" : ",\n") + inside + nlohmann::json(member.key).dump() + ": ";
      appendValue(member.value, inside, text);
    }
    text += '\n' + indent + '}';
  } else {
    text += textOfLeaf(value);
  }
}

}  // namespace

const JsonValue* memberOf(const JsonValue& value, const std::string& key) {
  const auto* object = std::get_if<JsonValue::Object>(&value.content);
  if (object == nullptr) return nullptr;
  const auto found =
      std::find_if(object->begin(), object->end(), [&](const JsonMember& member) { return member.key == key; });
  return found == object->end() ? nullptr : &found->value;
}

JsonValue* memberOf(JsonValue& value, const std::string& key) {
  return const_cast<JsonValue*>(memberOf(std::as_const(value), key));
}

std::string writeJson(const JsonValue& value) {
  std::string text;
  appendValue(value, "", text);
  return text + '\n';
}

JsonValue readJson(const std::string& text, FaultList& faults) {
  if (text.size() > kLongestText) {
    faults.add({}, "", fmt::format("the text has {} bytes; at most 64 MB are allowed", text.size()));
    faults.throwIfAny();
  }
  // The parser would take a NUL for the end of the text and pass over what follows.
  if (const auto nul = text.find('\0'); nul != text.npos) {
    faults.add(TokenCursor(text).advanceTo(nul), "", "a NUL byte; a scene file is UTF-8 text");
    faults.throwIfAny();
  }
  const TextSurvey survey(text);
  if (survey.excess) {
    faults.add(TokenCursor(text).advanceTo(survey.excess->offset), "", survey.excess->what);
    faults.throwIfAny();
  }
  TreeBuilder builder(text, faults);
  const bool isRead =
      nlohmann::json::sax_parse(survey.plain, &builder, nlohmann::json::input_format_t::json, true, true);
  if (!isRead) faults.throwIfAny();
  return builder.takeRoot();
}

std::string pointerTo(const std::string& pointer, const std::string& key) {
  std::string result = pointer + '/';
  for (const char character : key) {
    result += character == '~' ? "~0" : character == '/' ? "~1" : std::string(1, character);
  }
  return result;
}

std::string pointerTo(const std::string& pointer, std::size_t index) {
  return pointer + '/' + std::to_string(index);
}

}  // namespace cradle
