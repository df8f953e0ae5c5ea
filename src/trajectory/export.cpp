#include "trajectory/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include "core/csv_field.h"
#include "core/part_file.h"

namespace cradle {
namespace {

constexpr std::string_view kBodyColumns =
    "time_s,frame,body,px_m,py_m,pz_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s";
constexpr std::string_view kJointColumns = ",joint,coordinate,velocity,force";  // units go with the kind of the joint

constexpr std::string_view kContactColumns =
    "time_s,frame,contact,a,b,begin_s,end_s,fx_N,fy_N,fz_N,tx_N_m,ty_N_m,tz_N_m,x_m,y_m,z_m,normalx_N,normaly_N,"
    "normalz_N,frictionx_N,frictiony_N,frictionz_N";

/// Empty fields in place of some columns, each with its comma in front.
std::string emptyFields(std::string_view columns) {
  return std::string(static_cast<std::size_t>(std::ranges::count(columns, ',')), ',');
}

/// The lines of a frame: those of its bodies, then those of its joints.
class FrameLines {
 public:
  explicit FrameLines(const TrajectoryHeader& header) {
    for (const BodyRecord& body : header.bodies)
      if (body.hasStates()) bodies_.push_back(csvField(body.name));
    for (const JointRecord& joint : header.joints) joints_.push_back(csvField(joint.name));
    header_ = kBodyColumns;
    if (joints_.empty()) return;
    header_ += kJointColumns;
    afterBody_ = emptyFields(kJointColumns);
    beforeJoint_ = emptyFields(kBodyColumns.substr(kBodyColumns.find(",body")));
  }

  const std::string& header() const { return header_; }

  void append(const Frame& frame, fmt::memory_buffer& lines) const {
    const auto out = std::back_inserter(lines);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      fmt::format_to(out, "{},{},{}", frame.time, frame.number, bodies_[i]);
      for (const double value : stateNumbers(frame.states[i])) fmt::format_to(out, ",{}", value);
      fmt::format_to(out, "{}\n", afterBody_);
    }
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const JointState& joint = frame.joints[i];
      fmt::format_to(out, "{},{}{},{},{},{},{}\n", frame.time, frame.number, beforeJoint_, joints_[i], joint.coordinate,
                     joint.velocity, joint.force);
    }
  }

 private:
  std::vector<std::string> bodies_, joints_;  // names
  std::string header_, afterBody_, beforeJoint_;
};

/// Writes a header line, then the lines that appendFrame(number, lines) gives for each frame.
template <class AppendFrame>
void writeTable(const TrajectoryReader& reader, const std::string& path, std::string_view header,
                const std::function<void(long done)>& progress, const AppendFrame& appendFrame) {
  PartFile file(path);
  file.write(fmt::format("{}\n", header));
  fmt::memory_buffer lines;
  for (long number = 0; number < reader.frameCount(); ++number) {
    lines.clear();
    appendFrame(number, lines);
    file.write({lines.data(), lines.size()});
    progress(number + 1);
  }
  file.complete();
}

}  // namespace

void exportCsv(const TrajectoryReader& reader, const std::string& path,
               const std::function<void(long done)>& progress) {
  const FrameLines frameLines(reader.header());
  writeTable(reader, path, frameLines.header(), progress,
             [&](long number, fmt::memory_buffer& lines) { frameLines.append(reader.readFrame(number), lines); });
}

void exportContactsCsv(const TrajectoryReader& reader, const std::string& path,
                       const std::function<void(long done)>& progress) {
  const std::vector<LastingContact> contacts = reader.contacts();
  const auto nameOf = [&](int body) { return csvField(reader.header().bodies[static_cast<std::size_t>(body)].name); };
  writeTable(reader, path, kContactColumns, progress, [&](long number, fmt::memory_buffer& lines) {
    const double time = reader.frameTimes()[static_cast<std::size_t>(number)];
    for (const ContactWrench& wrench : reader.contactsAt(number)) {
      const LastingContact& contact = contacts[static_cast<std::size_t>(wrench.contact)];
      const auto out = std::back_inserter(lines);
      fmt::format_to(out, "{},{},{},{},{},{},", time, number, contact.id, nameOf(contact.bodyA), nameOf(contact.bodyB),
                     contact.begin);
      if (contact.end) fmt::format_to(out, "{}", *contact.end);
      const Vec3 friction = wrench.force - wrench.normalForce;
      for (const Vec3& vector : {wrench.force, wrench.torque, wrench.point, wrench.normalForce, friction})
        fmt::format_to(out, ",{},{},{}", vector.x(), vector.y(), vector.z());
      fmt::format_to(out, "\n");
    }
  });
}

}  // namespace cradle
