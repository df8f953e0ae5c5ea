#pragma once

#include <functional>

namespace cradle {

/// Does work(number, tell) for number = 0 .. count - 1, in processes beside each other where `processes` > 1: each
/// takes the next number when it is done with one, so that in which process a number is done is left to chance. Work
/// calls tell() for each part of it that is done, and done(parts) is called in this process with how many are in all.
/// The first Error of a process ends all of them and is thrown here; a signal is passed on to them. No other thread of
/// this process may run.
void shareAmongProcesses(int processes, long count,
                         const std::function<void(long number, const std::function<void()>& tell)>& work,
                         const std::function<void(long parts)>& done);

}  // namespace cradle
