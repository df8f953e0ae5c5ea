#include "trajectory/export.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <charconv>

#include "sample_trajectory.h"

namespace cradle {
namespace {

constexpr const char* kHeaderLine =
    "time_s,frame,body,px_m,py_m,pz_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s\n";

TEST(ExportCsv, WritesOneLineForEachFrameAndDynamicBody) {
  const TemporaryFolder folder;
  TrajectoryHeader header = sampleHeader();
  header.bodies[2].name = "a \"big\", bad\nname";
  header.joints.clear();
  TrajectoryWriter writer(folder.file("a.sqlite"), header);
  const BodyState still;
  const BodyState moving{Vec3(0.1, -0.0, 1e-7), Quat(0.5, -0.5, 0.5, -0.5), Vec3(1e22, 2, 5e-324),
                         Vec3(1.0 / 3, 0, -3)};
  writer.append(Frame{0, 0, {still, moving}, {}});
  writer.append(Frame{1, 0.1, {moving, still}, {}});
  writer.finish({});
  exportCsv(TrajectoryReader(folder.file("a.sqlite")), folder.file("a.csv"), [](long) {});
  EXPECT_EQ(contentOf(folder.file("a.csv")),
            std::string(kHeaderLine) +
                "0,0,ball,0,0,0,1,0,0,0,0,0,0,0,0,0\n"
                "0,0,\"a \"\"big\"\", bad\\x0aname\",0.1,-0,1e-07,0.5,-0.5,0.5,-0.5,1e+22,2,5e-324,"
                "0.3333333333333333,0,-3\n"
                "0.1,1,ball,0.1,-0,1e-07,0.5,-0.5,0.5,-0.5,1e+22,2,5e-324,0.3333333333333333,0,-3\n"
                "0.1,1,\"a \"\"big\"\", bad\\x0aname\",0,0,0,1,0,0,0,0,0,0,0,0,0\n");
  EXPECT_EQ(folder.count(), 2);
}

TEST(ExportCsv, WritesOneLineForEachFrameAndJoint) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
  writer.append(Frame{0, 0, {{}, {}}, {}, {{7.5, -0.1, 0}, {1e-3, 0, 20}}});
  writer.finish({});
  exportCsv(TrajectoryReader(folder.file("a.sqlite")), folder.file("a.csv"), [](long) {});
  std::string header(kHeaderLine);
  header.insert(header.size() - 1, ",joint,coordinate,velocity,force");
  EXPECT_EQ(contentOf(folder.file("a.csv")), header +
                                                 "0,0,ball,0,0,0,1,0,0,0,0,0,0,0,0,0,,,,\n"
                                                 "0,0,wedge,0,0,0,1,0,0,0,0,0,0,0,0,0,,,,\n"
                                                 "0,0,,,,,,,,,,,,,,,\"lid, \"\"old\"\"\",7.5,-0.1,0\n"
                                                 "0,0,,,,,,,,,,,,,,,rail,0.001,0,20\n");
}

TEST(ExportCsv, WritesNumbersThatReadBackBitByBit) {
  const TemporaryFolder folder;
  writeSample(folder.file("a.sqlite"), 20);
  exportCsv(TrajectoryReader(folder.file("a.sqlite")), folder.file("a.csv"), [](long) {});
  std::ifstream file(folder.file("a.csv"));
  std::string line;
  std::getline(file, line);
  const auto expectNumbers = [&](std::size_t start, auto... expected) {
    for (const double number : {expected...}) {
      double value = 0;
      const auto end = std::from_chars(line.data() + start, line.data() + line.size(), value).ptr;
      start = static_cast<std::size_t>(end - line.data()) + 1;
      expectSameBits(value, number);
    }
  };
  for (long number = 0; number < 20; ++number) {
    const Frame frame = sampleFrame(number);
    for (const BodyState& state : frame.states) {
      ASSERT_TRUE(std::getline(file, line));
      const std::size_t start = line.find(',', line.find(',', line.find(',') + 1) + 1) + 1;
      std::apply([&](auto... numbers) { expectNumbers(start, numbers...); }, stateNumbers(state));
    }
    for (const JointState& joint : frame.joints) {
      ASSERT_TRUE(std::getline(file, line));
      const std::size_t force = line.rfind(','), velocity = line.rfind(',', force - 1);
      expectNumbers(line.rfind(',', velocity - 1) + 1, joint.coordinate, joint.velocity, joint.force);
    }
  }
  EXPECT_FALSE(std::getline(file, line));
}

TEST(ExportCsv, LeavesNothingBehindWhenItCannotBeWritten) {
  const TemporaryFolder folder;
  writeSample(folder.file("a.sqlite"), 100);
  const TrajectoryReader reader(folder.file("a.sqlite"));
  expectError(ErrorKind::output, "/dev/full", [&] { exportCsv(reader, "/dev/full", [](long) {}); });
  expectError(ErrorKind::output, "missing", [&] { exportCsv(reader, folder.file("missing/a.csv"), [](long) {}); });
  writeContent(folder.file("a.csv"), "precious");
  const pid_t process = fork();
  if (process == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{10000, 10000};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      exportCsv(reader, folder.file("a.csv"), [](long) {});
    } catch (const Error& error) {
      _exit(error.kind() == ErrorKind::output ? 0 : 1);
    }
    _exit(2);
  }
  int status = -1;
  waitpid(process, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(contentOf(folder.file("a.csv")), "precious");
  EXPECT_EQ(folder.count(), 2);
}

}  // namespace
}  // namespace cradle
