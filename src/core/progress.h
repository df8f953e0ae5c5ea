#pragma once

#include <chrono>
#include <string>

namespace cradle {

/// Progress of long work on stderr, with time left: one line that is redrawn on a terminal, and elsewhere a plain line
/// every ten seconds, more seldom while it says the same. Silent when `quiet`. The line is ended when the object goes.
class Progress {
 public:
  /// `unit` names what is counted ("frames"); total > 0.
  Progress(std::string task, std::string unit, long total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of `total` are finished. Cheap enough to call for every frame.
  void update(long done);

  /// The simulation of the next of them, or of what comes after the last, has come to a time (s).
  void showTime(double time);

  /// `done` of `total` were finished already, by an earlier run: they say nothing about the time left.
  void skipTo(long done);

  /// Ends a line that is being redrawn, so that something else can be printed.
  void endLine();

 private:
  using Clock = std::chrono::steady_clock;
  std::string line(const std::string& within) const;
  void draw(bool isDue, const std::string& within);

  std::string task_, unit_;
  long total_, skipped_ = 0, done_ = 0;
  bool quiet_, animated_, drawn_ = false;
  long told_ = -1;  // of done_, in the last plain line
  std::chrono::milliseconds logInterval_;
  Clock::time_point start_, lastDrawn_;
};

}  // namespace cradle
