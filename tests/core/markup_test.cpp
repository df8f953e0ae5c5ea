#include "core/markup.h"

#include <gtest/gtest.h>

#include <string>

namespace cradle {
namespace {

std::string base64Of(const std::string& text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// RFC 4648, section 10.
TEST(Markup, Base64IsThatOfItsStandard) {
  EXPECT_EQ(base64Of(""), "");
  EXPECT_EQ(base64Of("f"), "Zg==");
  EXPECT_EQ(base64Of("fo"), "Zm8=");
  EXPECT_EQ(base64Of("foo"), "Zm9v");
  EXPECT_EQ(base64Of("foob"), "Zm9vYg==");
  EXPECT_EQ(base64Of("\xff\xff\xfe"), "///+");
}

TEST(Markup, TextIsNoMarkup) {
  EXPECT_EQ(escapedMarkup("a < b & \"c\" > d"), "a &lt; b &amp; &quot;c&quot; &gt; d");
  EXPECT_EQ(escapedMarkup("\xef\xbf\xbd\xef\xbf\xbe\xef\xbf\xbf."), "\xef\xbf\xbd\\ufffe\\uffff.");
}

}  // namespace
}  // namespace cradle
