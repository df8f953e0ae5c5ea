#pragma once

namespace cradle {

/// From now on SIGINT, SIGTERM and SIGHUP (a terminal that is closed; ignored under nohup) are noted instead of ending
/// the program at once, so that files are left in order; the same signal again, save SIGHUP, ends it at once. Work that
/// does not look within 3 s is ended with 128 and the number of the signal, and what would remain (core/crash.h) goes.
/// SIGPIPE and SIGXFSZ are ignored: a broken pipe, or a file beyond the shell's limit (ulimit -f), shows as a failed
/// write.
void noteInterruptions();

/// The signal that was noted (SIGINT, SIGTERM or SIGHUP), or 0.
int interruptingSignal();

/// Throws Error(ErrorKind::interrupted) if a signal was noted; from then on the end may take its time.
void throwIfInterrupted();

}  // namespace cradle
