#include "study/growing_table.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColumns = "method,error\n";

/// A folder that goes with the object.
struct TableFolder {
  TableFolder() { EXPECT_NE(mkdtemp(name), nullptr); }
  ~TableFolder() { fs::remove_all(name); }

  std::string table() const { return std::string(name) + "/t.csv"; }
  std::string part() const { return table() + ".part"; }

  char name[32] = "/tmp/growing_table_XXXXXX";
};

std::string textOf(const std::string& path) {
  std::ifstream file(path);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

TEST(GrowingTable, GoesIfItHasNoLine) {
  const TableFolder folder;
  {
    const GrowingTable table(folder.table(), kColumns);
    EXPECT_EQ(textOf(folder.part()), kColumns);
  }
  EXPECT_TRUE(fs::is_empty(folder.name));
}

TEST(GrowingTable, StaysForTheNextRunWithALineOrBesideAnotherThatHasSome) {
  const TableFolder folder;
  GrowingTable(folder.table(), kColumns).append("rk4,1\n");
  EXPECT_EQ(textOf(folder.part()), std::string(kColumns) + "rk4,1\n");
  { const GrowingTable asItWas(folder.table(), kColumns, fs::file_size(folder.part())); }
  EXPECT_EQ(textOf(folder.part()), std::string(kColumns) + "rk4,1\n");
  GrowingTable(folder.table(), kColumns).keep();
  EXPECT_EQ(textOf(folder.part()), kColumns);
}

TEST(GrowingTable, GetsItsNameWhenComplete) {
  const TableFolder folder;
  GrowingTable(folder.table(), kColumns).complete();
  EXPECT_EQ(textOf(folder.table()), kColumns);
  EXPECT_FALSE(fs::exists(folder.part()));
}

}  // namespace
}  // namespace cradle
