#include "core/csv_field.h"

#include <gtest/gtest.h>

namespace cradle {
namespace {

TEST(CsvField, StandsInQuotesWhereItHasTo) {
  EXPECT_EQ(csvField("ball 1"), "ball 1");
  EXPECT_EQ(csvField("a, \"b\""), "\"a, \"\"b\"\"\"");
}

// OWASP, "CSV Injection": the characters that a formula may begin with.
TEST(CsvField, IsNoFormula) {
  for (const std::string text : {"=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\n=1", "\uff1d1", "\uff0b1", "\uff0d1",
                                 "\uff20A", "=HYPERLINK(\"http://x\", \"y\")"}) {
    const std::string field = csvField(text);
    EXPECT_TRUE(field.starts_with("'") || field.starts_with("\"'")) << field;
  }
}

TEST(CsvField, HasNothingThatATerminalObeys) {
  EXPECT_EQ(csvField("a\x1b[31mb"), "a\\x1b[31mb");
  EXPECT_EQ(csvField(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(csvField("a\u202eb"), "a\\xe2\\x80\\xaeb");
  EXPECT_EQ(csvField("a\rb\n\tc"), "a\\x0db\\x0a\\x09c");
}

TEST(CsvField, ComesBackFromATable) {
  const std::vector<std::string> texts = {"a",          "",    "=1+1", "'=1", "'",       "''",   "-",
                                          "a, \"b\" c", "@=x", "'a",   "-=1", "\uff1d1", "a\\tb"};
  std::string line;
  for (const std::string& text : texts) line += (line.empty() ? "" : ",") + csvField(text);
  EXPECT_EQ(csvLines(line + "\n").lines.at(0), texts);
}

}  // namespace
}  // namespace cradle
