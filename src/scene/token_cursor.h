#pragma once

#include <string_view>

#include "scene/text_place.h"

namespace cradle {

/// Walks a JSON text token by token, in step with a parser, to say where each token stands. It never checks the text:
/// on a text that is no JSON its places are of no use, but it stays inside.
class TokenCursor {
 public:
  /// `text` must outlive the cursor. A byte order mark at its start is passed over.
  explicit TokenCursor(std::string_view text);

  /// Passes the blanks, comments, commas and colons before the next token, and says where that token is.
  TextPlace findToken();
  /// findToken, then passes that token.
  TextPlace takeToken();
  /// Place of the byte at `offset`, which must not lie before the cursor; the cursor moves there.
  TextPlace advanceTo(std::size_t offset);

  /// Goes back before the token that was taken last if the byte at `offset` is part of it.
  void returnToTokenWith(std::size_t offset);

  /// What the cursor has not passed yet.
  std::string_view rest() const { return text_.substr(offset_); }
  /// True if a comma was the last separator before the token that findToken found.
  bool followsComma() const { return followsComma_; }

 private:
  void passByte();
  void passComment();
  void passString();

  std::string_view text_;
  std::size_t offset_ = 0, takenOffset_ = 0;
  TextPlace place_, takenPlace_;
  bool followsComma_ = false;
};

}  // namespace cradle
