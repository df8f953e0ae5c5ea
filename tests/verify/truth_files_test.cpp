#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "image/temporary_folder.h"
#include "verify/npy_reader.h"
#include "verify/truth_frame.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::string bytesOfNpy(const std::string& header, const std::string& numbers) {
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size());
  bytes += '\0';
  return bytes + header + numbers;
}

class NpyReader : public testing::Test {
 protected:
  std::string write(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    return path_;
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_ / "a.npy";
  const std::string header_ = "{'descr': '<u2', 'fortran_order': False, 'shape': (2, 3), }   \n";
};

TEST_F(NpyReader, NumbersAreThoseOfTheFile) {
  write(bytesOfNpy(header_, std::string("\1\0\2\0\3\0\0\1\377\377\0\0", 12)));
  EXPECT_THAT(readNpy<std::uint16_t>(path_, {2, 3}), ElementsAre(1, 2, 3, 256, 65535, 0));
}

TEST_F(NpyReader, OtherShapesTypesOrdersAndSizesAreRefused) {
  const auto expectRefusal = [&](const std::string& bytes, const char* words) {
    write(bytes);
    EXPECT_THAT([&] { readNpy<std::uint16_t>(path_, {2, 3}); }, ThrowsMessage<Error>(HasSubstr(words)));
  };
  const std::string numbers(12, '\0');
  expectRefusal(bytesOfNpy(header_, numbers.substr(1)), "has 84 bytes; its header promises 85");
  expectRefusal(bytesOfNpy(header_, numbers + "x"), "its header promises");
  expectRefusal(bytesOfNpy("{'descr': '<u2', 'fortran_order': True, 'shape': (2, 3), }\n", numbers), "has the header");
  expectRefusal(bytesOfNpy("{'descr': '<u2', 'fortran_order': False, 'shape': (3, 2), }\n", numbers), "has the header");
  expectRefusal(bytesOfNpy("{'descr': '>u2', 'fortran_order': False, 'shape': (2, 3), }\n", numbers), "has the header");
  expectRefusal("PK", "is no NumPy file");
}

/// Runs go down the columns: of a picture 3 wide and 2 high, 1 + 2 + 3 is the lower left pixel and the upper middle
/// one.
TEST(MaskOf, RunLengthsGoDownColumnsAndEndWithThePicture) {
  InstanceRecord record;
  record.runs = {1, 2, 3};
  const auto mask = maskOf(record, 3, 2);
  ASSERT_TRUE(mask);
  EXPECT_THAT(*mask, ElementsAre(false, true, false, true, false, false));
  for (const std::vector<long>& runs : {std::vector<long>{1, 2}, {1, 2, 4}, {-1, 7}, {}}) {
    record.runs = runs;
    EXPECT_FALSE(maskOf(record, 3, 2));
  }
}

TEST(Findings, TheWorstIsByItsShareOfWhatIsAllowed) {
  Findings findings;
  const auto fault = [](const char* found) { return [found] { return Fault{{"a"}, found, ""}; }; };
  findings.add(Aspect::depth, 0.5, 1, fault("none"));
  EXPECT_TRUE(findings.hold());
  findings.add(Aspect::depth, 3, 1, fault("three"));
  findings.add(Aspect::depth, 4, 100, fault("none"));
  findings.add(Aspect::depth, 0.2, 0.1, fault("twice"));
  const Tally& tally = findings.of(Aspect::depth);
  EXPECT_EQ(tally.values, 4);
  EXPECT_EQ(tally.faults, 2);
  ASSERT_TRUE(tally.fault);
  EXPECT_EQ(tally.fault->found, "three");
  findings.add(Aspect::flow, std::nan(""), 1, fault("no number"));
  EXPECT_EQ(findings.of(Aspect::flow).faults, 1);
}

}  // namespace
}  // namespace cradle
