#pragma once

#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trajectory/state_hash.h"
#include "trajectory/trajectory.h"

// Trajectories as SQLite files; docs/trajectory_file.md describes the tables.

namespace cradle {

class Database;
class TrajectoryReader;

/// How often a running simulation's frames become visible to others, and safe from its sudden end.
constexpr std::chrono::milliseconds kCommitInterval{500};

/// Writes a trajectory to FILE.part, a valid database at every moment, and renames it to FILE at the end. A run that is
/// not finished leaves FILE.part if it has at least one frame, else nothing; FILE itself is not touched before.
class TrajectoryWriter {
 public:
  /// Replaces an earlier FILE.part. Throws Error(output) if FILE cannot be written there, is anything but a regular
  /// file, or is being written by another run.
  TrajectoryWriter(const std::string& path, const TrajectoryHeader& header,
                   std::chrono::milliseconds commitInterval = kCommitInterval);
  /// Goes on with the FILE.part of an ended run, behind its checkpoint: what it has after that is dropped, and all
  /// cameras, which are to be told again. Throws as above, and if there is none.
  TrajectoryWriter(const std::string& path, const TrajectoryHeader& header, const Checkpoint& checkpoint);
  /// Into a file without a name, below TMPDIR, for a TrajectoryReader. Throws Error(output).
  explicit TrajectoryWriter(const TrajectoryHeader& header);
  ~TrajectoryWriter();
  TrajectoryWriter(const TrajectoryWriter&) = delete;
  TrajectoryWriter& operator=(const TrajectoryWriter&) = delete;

  /// Frames count from 0 without gaps, in order of time, with one state for each body that moves and each joint. Throws
  /// Error(unstable) if a number is not finite, Error(output) if it cannot be written. Amortised O(bodies).
  void append(const Frame& frame);
  /// Events in order of time.
  void append(const Event& event);
  /// A contact, before its first frame, and again when it has ended.
  void append(const LastingContact& contact);

  /// The camera of a frame, each once.
  void append(const CameraPose& camera);

  /// Of the frame that was appended last; replaces the one before.
  void append(const Checkpoint& checkpoint);

  bool hasFrame() const { return framesAppended_ > 0; }

  /// Lets readers of FILE.part see all that was appended. Throws Error(output).
  void flush();

  /// Completes the file and gives it its name, if it is to have one. There must be a frame. Throws Error(output).
  void finish(const RunCost& cost);

  /// The same for a copy of a finished trajectory: with its cost, and what became known of it.
  void finishAs(const TrajectoryReader& copied);

  /// Ends a run that is not finished, as the destructor does, and says where its frames are: FILE.part, or empty if
  /// nothing was kept (or the run is finished).
  std::string keptPath();

 private:
  friend class TrajectoryReader;
  struct Session;
  void begin(std::unique_ptr<Database> database, const TrajectoryHeader& header);
  void nameColumns(const TrajectoryHeader& header);
  void beginTransaction();
  void complete();
  void dropBehind(const Checkpoint& checkpoint);
  void readUntil(const Checkpoint& checkpoint);
  std::unique_ptr<Database> release();
  void requireFinite(const Frame& frame) const;
  void writeFrame(const Frame& frame);
  void writeContacts(const Frame& frame);
  void commitIfDue();
  void endUnfinished() noexcept;

  std::string path_, part_;
  std::vector<std::string> bodyNames_, jointNames_;
  std::vector<int> movingBodies_;  // ids
  using ForceNumbers = std::array<double, 14>;
  std::map<long, ForceNumbers> lastForces_;  // the last row of each contact that goes on
  std::vector<LastingContact> ended_;        // since the last frame
  std::chrono::milliseconds commitInterval_;
  std::chrono::steady_clock::time_point lastCommit_;
  long framesAppended_ = 0, framesCommitted_ = 0;
  double lastTime_ = 0;           // s
  bool transactionWhole_ = true;  // the open transaction holds no half-written frame
  bool isFinished_ = false;
  Hash stateHash_;
  std::unique_ptr<Session> session_;  // null when ended
};

/// Reads a trajectory, finished or not (a .part, even while it is being written: the frames there are when it is
/// opened). Throws Error(usage) if the file is not a trajectory or is damaged.
class TrajectoryReader {
 public:
  explicit TrajectoryReader(const std::string& path);
  /// Of the file without a name that `finished` wrote, which has ended then.
  explicit TrajectoryReader(TrajectoryWriter& finished);
  TrajectoryReader(TrajectoryReader&&) noexcept;
  ~TrajectoryReader();

  const std::string& path() const { return path_; }
  const TrajectoryHeader& header() const { return header_; }
  const std::vector<double>& frameTimes() const { return frameTimes_; }  // s, ascending
  long frameCount() const { return static_cast<long>(frameTimes_.size()); }

  /// Frame `number` of 0..frameCount()-1, in any order. Throws as the constructor does. O(bodies).
  Frame readFrame(long number) const;
  std::vector<Event> events() const;

  /// Whether it tells of contacts that last: earlier versions did not.
  bool hasContacts() const;

  /// By number.
  std::vector<LastingContact> contacts() const;

  /// What lasting contacts do at a frame, by their numbers. Amortised O(contacts) if frames are read in their order.
  std::vector<ContactWrench> contactsAt(long number) const;

  /// The checkpoint of an unfinished run, if it has come to one.
  struct StoredCheckpoint {
    std::string record, fingerprint;  // of Checkpoint
    std::string stateHash;            // of the frames by then
  };
  std::optional<StoredCheckpoint> checkpoint() const;

  /// By frame, of those whose camera was known. Empty in trajectories of earlier versions.
  std::vector<CameraPose> cameras() const;

  /// Everything of the table `meta`, as text.
  const std::map<std::string, std::string>& meta() const { return meta_; }
  /// s: the time from which on the motion is one of many; none if that is not known, or never.
  std::optional<double> horizon() const;
  /// Of all frames, as the file says; empty if the run was not finished.
  std::string stateHash() const;
  /// Of the frames that are there: reads all of them, and throws where the file says another hash.
  std::string hashOfFrames() const;
  bool isFinished() const { return !stateHash().empty(); }
  /// Whether the run became unstable before its end, and was finished then.
  bool hasFailed() const;
  /// Zero if the run was not finished.
  RunCost cost() const;

 private:
  struct Session;
  void readAll();
  void readMeta();
  void readTextures();
  void readMeshes();
  void readBodies();
  void readJoints();
  void readFrameTimes();
  void readJointStates(Frame& frame) const;
  void readForcesUntil(long number) const;

  std::string path_;
  TrajectoryHeader header_;
  std::vector<int> movingBodies_;  // ids
  std::vector<double> frameTimes_;
  std::map<std::string, std::string> meta_;
  std::unique_ptr<Session> session_;
};

/// Adds to the table `meta` of a whole trajectory, that this program has just written, what became known after it.
/// Throws Error(output).
void addToMeta(const std::string& path, const std::string& key, const std::string& text);

/// Whether `path` is a SQLite file, so that a command can tell a trajectory, also one that is damaged or of another
/// program, from a scene. Throws nothing: a file that cannot be read is none.
bool isDatabaseFile(const std::string& path);

/// Whether it is one of cradle's, complete or not.
bool isTrajectoryFile(const std::string& path);

/// Throws Error(output) if a file is there that is neither empty nor a trajectory: a slip of the hand does not cost a
/// file of another kind, the scene's own for one.
void requireNoOtherFile(const std::string& path);

}  // namespace cradle
