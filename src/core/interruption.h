#pragma once

namespace cradle {

/// From now on SIGINT and SIGTERM are noted instead of ending the program at once, so that files are left in order;
/// a second signal ends it at once. SIGPIPE and SIGXFSZ are ignored: a broken pipe, or a file beyond the shell's limit
/// (ulimit -f), shows as a failed write.
void noteInterruptions();

/// The signal that was noted (SIGINT or SIGTERM), or 0.
int interruptingSignal();

/// Throws Error(ErrorKind::interrupted) if a signal was noted.
void throwIfInterrupted();

}  // namespace cradle
