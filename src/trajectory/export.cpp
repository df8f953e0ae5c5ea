#include "trajectory/export.h"

#include <fmt/format.h>

#include <iterator>
#include <vector>

#include "core/csv_field.h"
#include "core/part_file.h"

namespace cradle {
namespace {

constexpr const char* kColumns =
    "time_s,frame,body,px_m,py_m,pz_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s\n";

}  // namespace

void exportCsv(const TrajectoryReader& reader, const std::string& path,
               const std::function<void(long done)>& progress) {
  std::vector<std::string> names;
  for (const BodyRecord& body : reader.header().bodies)
    if (body.hasStates()) names.push_back(csvField(body.name));

  PartFile file(path);
  file.write(kColumns);
  fmt::memory_buffer lines;
  for (long number = 0; number < reader.frameCount(); ++number) {
    const Frame frame = reader.readFrame(number);
    lines.clear();
    for (std::size_t i = 0; i < names.size(); ++i) {
      fmt::format_to(std::back_inserter(lines), "{},{},{}", frame.time, number, names[i]);
      for (const double value : stateNumbers(frame.states[i])) fmt::format_to(std::back_inserter(lines), ",{}", value);
      lines.push_back('\n');
    }
    file.write({lines.data(), lines.size()});
    progress(number + 1);
  }
  file.complete();
}

}  // namespace cradle
