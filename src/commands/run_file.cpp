#include "commands/run_file.h"

#include <fmt/format.h>

#include <span>

#include "core/console.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/printable.h"
#include "core/read_file.h"
#include "simulate/run_record.h"
#include "simulate/simulate.h"

namespace cradle {

namespace {

/// None if what the file tells up to the checkpoint is not what was written. Throws what reading throws.
std::optional<Checkpoint> soundCheckpoint(const TrajectoryReader& told,
                                          const TrajectoryReader::StoredCheckpoint& stored) {
  const Checkpoint checkpoint = checkpointOf(runRecordOf(stored.record), stored.record);
  if (told.isFinished() || checkpoint.frame >= told.frameCount() || std::ssize(told.events()) < checkpoint.eventCount ||
      std::ssize(told.contacts()) < checkpoint.contactCount)
    return std::nullopt;
  Hash hash;
  for (long frame = 0; frame <= checkpoint.frame; ++frame) addFrame(told.readFrame(frame), hash);
  return hash.hex() == stored.stateHash ? std::optional(checkpoint) : std::nullopt;
}

}  // namespace

RunFile::RunFile(const std::string& output, const Scene& scene, const World& world, bool isStrict, bool isFresh)
    : part_(partPath(output)), scene_(scene), header_(headerOf(scene, world.plan())), isStrict_(isStrict) {
  if (!isFresh) from_ = findCheckpoint();
  if (from_) told_.emplace(part_);
  from_ ? writer_.emplace(output, header_, *from_) : writer_.emplace(output, header_);
}

std::string RunFile::fingerprint() const {
  constexpr std::uint64_t kMaxProgram = 1'000'000'000;  // bytes
  static const std::string program = textHash(readFile("/proc/self/exe", kMaxProgram, ErrorKind::output));
  Hash hash;
  const auto add = [&hash](const std::string& text) {
    const std::string line = text + '\n';
    hash.add(std::as_bytes(std::span(line)));
  };
  add(program), add(scene_.text), add(header_.plan), add(header_.method);
  add(isStrict_ ? "strict" : "");  // would have ended at what others have only told
  add(fmt::format("{} {} {} {}", scene_.accuracy, scene_.duration, scene_.method ? int(scene_.method->name) : -1,
                  scene_.method ? scene_.method->timeStep.value_or(0) : 0));
  for (const Model& mesh : header_.meshes) {
    hash.add(std::as_bytes(std::span(mesh.drawn.vertices)));
    hash.add(std::as_bytes(std::span(mesh.drawn.triangles)));
  }
  return hash.hex();
}

/// That of an unfinished run of the scene, if there is one that can be gone on from. Sets `refusal_`.
std::optional<Checkpoint> RunFile::findCheckpoint() {
  if (!isTrajectoryFile(part_)) return std::nullopt;
  try {
    const TrajectoryReader told(part_);
    const auto stored = told.checkpoint();
    if (!stored) return std::nullopt;  // ended before its first one: little is lost
    if (stored->fingerprint != fingerprint()) {
      refusal_ = "is of another scene, other options or another program";
      return std::nullopt;
    }
    if (const auto checkpoint = soundCheckpoint(told, *stored)) return checkpoint;
  } catch (const Error&) {  // told below
  }
  refusal_ = "is damaged";
  return std::nullopt;
}

void RunFile::tellOfCheckpoint(const std::string& hint) const {
  if (from_) show(stderr, "note: going on after frame {} of {}{}\n", from_->frame, printableLine(part_), hint);
  if (!refusal_.empty()) show(stderr, "note: {} {}; the run begins anew\n", printableLine(part_), refusal_);
}

long RunFile::tellKept(const std::function<void(const Frame&)>& tellFrame,
                       const std::function<void(const Event&)>& tellEvent) {
  if (!from_) return 0;
  const std::vector<Event> events = told_->events();
  auto event = events.begin();
  for (long number = 0; number <= from_->frame; ++number) {
    throwIfInterrupted();
    const Frame frame = told_->readFrame(number);
    for (; event != events.end() && event->time <= frame.time; ++event) tellEvent(*event);
    tellFrame(frame);
  }
  told_.reset();
  return from_->frame + 1;
}

}  // namespace cradle
