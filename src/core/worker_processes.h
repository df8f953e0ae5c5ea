#pragma once

#include <functional>

namespace cradle {

/// Does work(number) for number = 0 .. count - 1, in processes beside each other where `processes` > 1: each takes the
/// next number when it is done with one, so that in which process a number is done is left to chance. done(finished)
/// is called in this process with how many are. The first Error of a process ends all of them and is thrown here; a
/// signal is passed on to them. No other thread of this process may run.
void shareAmongProcesses(int processes, long count, const std::function<void(long number)>& work,
                         const std::function<void(long finished)>& done);

}  // namespace cradle
