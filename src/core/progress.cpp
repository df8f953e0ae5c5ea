#include "core/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace cradle {
namespace {

constexpr std::chrono::milliseconds kTerminalInterval{100};  // ten redraws a second look smooth
constexpr std::chrono::milliseconds kLogInterval{10000};     // keeps logs short
constexpr std::chrono::milliseconds kMaxLogInterval{300000};

std::string minutesAndSeconds(double seconds) {
  const long whole = static_cast<long>(seconds + 0.5);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

Progress::Progress(std::string task, std::string unit, long total, bool quiet)
    : task_(std::move(task)),
      unit_(std::move(unit)),
      total_(total),
      quiet_(quiet),
      animated_(isatty(STDERR_FILENO) == 1),
      logInterval_(kLogInterval),
      start_(Clock::now()),
      lastDrawn_(start_) {}

Progress::~Progress() {
  endLine();
}

void Progress::endLine() {
  if (!drawn_ || !animated_) return;
  std::fputc('\n', stderr);  // what cannot be told is lost
  drawn_ = false;
}

std::string Progress::line(const std::string& within) const {
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  if (done_ >= total_ && within.empty())
    return fmt::format("{}: {} {} in {}", task_, total_, unit_, minutesAndSeconds(elapsed));
  if (done_ >= total_) return fmt::format("{}: {}/{} {}{}", task_, done_, total_, unit_, within);
  const long own = done_ - skipped_;
  const double left = own > 0 ? elapsed * static_cast<double>(total_ - done_) / static_cast<double>(own) : 0;
  return fmt::format("{}: {}/{} {}{}, {} left", task_, done_, total_, unit_, within,
                     own > 0 ? minutesAndSeconds(left) : "?");
}

void Progress::skipTo(long done) {
  skipped_ = done_ = done;
  start_ = Clock::now();
}

void Progress::update(long done) {
  done_ = done;
  draw(done >= total_ && (animated_ || drawn_), "");
}

void Progress::showTime(double time) {
  draw(false, fmt::format(", {:.6g} s simulated", time));
}

void Progress::draw(bool isDue, const std::string& within) {
  const auto now = Clock::now();
  if (quiet_ || !(isDue || now - lastDrawn_ >= (animated_ ? kTerminalInterval : logInterval_))) return;
  // A study may be at one of its methods for minutes.
  logInterval_ = done_ == told_ && within.empty() ? std::min(2 * logInterval_, kMaxLogInterval) : kLogInterval;
  told_ = done_;
  lastDrawn_ = now;
  drawn_ = true;
  const std::string text = animated_ ? "\r\x1b[K" + line(within) : line(within) + "\n";
  std::fputs(text.c_str(), stderr);  // what cannot be told is lost
  std::fflush(stderr);
}

}  // namespace cradle
