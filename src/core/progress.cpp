#include "core/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace cradle {
namespace {

constexpr std::chrono::milliseconds kTerminalInterval{100};  // ten redraws a second look smooth
constexpr std::chrono::milliseconds kLogInterval{10000};     // keeps logs short

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

std::string Progress::line(long done) const {
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  if (done >= total_) return fmt::format("{}: {} {} in {}", task_, total_, unit_, minutesAndSeconds(elapsed));
  const long own = done - skipped_;
  const double left = own > 0 ? elapsed * static_cast<double>(total_ - done) / static_cast<double>(own) : 0;
  return fmt::format("{}: {}/{} {}, {} left", task_, done, total_, unit_, own > 0 ? minutesAndSeconds(left) : "?");
}

void Progress::skipTo(long done) {
  skipped_ = done;
  start_ = Clock::now();
}

void Progress::update(long done) {
  const auto now = Clock::now();
  const bool due = now - lastDrawn_ >= (animated_ ? kTerminalInterval : kLogInterval);
  if (quiet_ || (!due && !(done >= total_ && (animated_ || drawn_)))) return;
  lastDrawn_ = now;
  drawn_ = true;
  const std::string text = animated_ ? "\r\x1b[K" + line(done) : line(done) + "\n";
  std::fputs(text.c_str(), stderr);  // what cannot be told is lost
  std::fflush(stderr);
}

}  // namespace cradle
