#include "core/csv_field.h"

#include <gtest/gtest.h>

namespace cradle {
namespace {

TEST(CsvField, StandsInQuotesWhereItHasTo) {
  EXPECT_EQ(csvField("ball 1"), "ball 1");
  EXPECT_EQ(csvField("a, \"b\"\n"), "\"a, \"\"b\"\"\n\"");
}

// OWASP, "CSV Injection": the characters that a formula may begin with.
TEST(CsvField, IsNoFormula) {
  for (const std::string text : {"=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "=HYPERLINK(\"http://x\", \"y\")"}) {
    const std::string field = csvField(text);
    EXPECT_TRUE(field.starts_with("'") || field.starts_with("\"'")) << field;
  }
}

TEST(CsvField, ComesBackFromATable) {
  const std::vector<std::string> texts = {"a", "", "=1+1", "'=1", "'", "''", "-", "a, \"b\"\nc", "\r=x", "'a"};
  std::string line;
  for (const std::string& text : texts) line += (line.empty() ? "" : ",") + csvField(text);
  EXPECT_EQ(csvLines(line + "\n").lines.at(0), texts);
}

}  // namespace
}  // namespace cradle
